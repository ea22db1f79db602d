"""What is needed to draw a network and to name its parts."""

from __future__ import annotations

from enum import StrEnum

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.networks.line_controls import LineControl
from drivora_service.networks.markings import Marking

Point = tuple[float, float]
Line = tuple[Point, ...]


class LaneKind(StrEnum):
    """What a lane is."""

    ROAD = "road"
    JUNCTION = "junction"
    SIDEWALK = "sidewalk"
    CROSSING = "crossing"
    WALKING_AREA = "walking_area"
    OTHER = "other"


class LaneGeometry(Schema):
    """A lane as a line with a width."""

    id: str
    shape: Line = Field(description="Centre line, metres; of a walking area its outline.")
    width: float
    drivable: bool
    walkable: bool
    internal: bool = Field(description="Inside a junction.")
    kind: LaneKind
    edge: str
    index: int = Field(description="Number of the lane on its edge; 0 is the rightmost.")
    street: str = Field(description='Name of the street; "" where the network has none.')
    speed_limit: float = Field(description="m/s.")
    left_marking: Marking = Field(description="Line at its left border.")
    right_marking: Marking = Field(description="Line at its right border.")


class Crossing(Schema):
    """A crossing for walkers."""

    id: str = Field(description="Its lane.")
    junction: str
    shape: Line = Field(description="Centre line, metres.")
    width: float
    outline: Line = Field(description="Metres.")
    edges: tuple[str, ...] = Field(description="Edges that it crosses.")
    light: str = Field(description='Traffic light of the walkers; "" without one.')
    links: tuple[int, ...] = Field(description="Their positions in the light's states.")


class Movement(Schema):
    """A permitted movement from the end of a lane."""

    to_edge: str
    via: tuple[str, ...] = Field(description="Lanes inside the junction.")
    direction: str = Field(
        description="SUMO's letter: s straight, l left, r right, t turn-around, L and R partial."
    )
    right_of_way: str = Field(
        description="SUMO's letter without a signal: M major, m minor, s stop, w all-way stop, "
        "= equal, Z zip merge; o and O signal off."
    )
    link: int = Field(description="Position of its signal in the light's states; -1 without one.")


class StopLineGeometry(Schema):
    """The end of a lane before a junction."""

    lane: str
    junction: str
    points: tuple[Point, Point] = Field(description="Left and right end, metres.")
    control: LineControl
    light: str = Field(description='Traffic light; "" without one.')
    movements: tuple[Movement, ...]


class Phase(Schema):
    """A stage of a light's programme."""

    duration: float = Field(description="Seconds.")
    state: str = Field(description="SUMO's letter for each link.")


class LightLink(Schema):
    """A signal of a traffic light."""

    index: int = Field(description="Position in the states.")
    lane: str = Field(description="Lane before the signal.")
    to_lane: str
    direction: str = Field(description="SUMO's letter.")
    stop_line: tuple[Point, Point] | None = Field(
        description="Left and right end, metres; null for walkers."
    )


class TrafficLight(Schema):
    """A traffic light with the network's programme; a scenario may set other durations."""

    id: str
    position: Point = Field(description="Middle of the lanes' ends before its signals, metres.")
    links: tuple[LightLink, ...]
    program: str = Field(description="Id of the programme.")
    offset: float = Field(description="Seconds by which it is delayed.")
    phases: tuple[Phase, ...]


class Sign(Schema):
    """A traffic sign, as it follows from the right of way at a stop line."""

    kind: LineControl
    lane: str = Field(description="Rightmost lane that it is for.")
    position: Point = Field(description="Right of the road, metres.")
    heading: float = Field(description="Degrees from east, along the lane.")


class NetworkGeometry(Schema):
    """All that is needed to draw a network."""

    name: str
    sha256: str
    bounds: tuple[float, float, float, float]
    lanes: tuple[LaneGeometry, ...]
    junctions: dict[str, Line] = Field(description="Outline of each junction, metres.")
    junction_types: dict[str, str] = Field(
        description="SUMO's type of each junction, also of those without an outline."
    )
    crossings: tuple[Crossing, ...]
    stop_lines: tuple[StopLineGeometry, ...]
    traffic_lights: tuple[TrafficLight, ...]
    signs: tuple[Sign, ...]
