"""A road network as its ``.net.xml`` has it, read with the standard library alone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from tests.recomputation.recording import Floats

_TOWNS = Path(__file__).resolve().parents[2] / "sumo_nets"


@dataclass(frozen=True, slots=True, kw_only=True)
class Movement:
    """A connection from the end of a lane.

    Attributes:
        via: The lane inside the junction that it begins with, or "".
        to: The lane behind the junction.
        light: Id of the traffic light that controls it, or "".
        link: Place of its signal in the light's state.
        state: SUMO's letter of its right of way: ``s`` has a stop sign, ``w`` an all-way stop.
    """

    via: str
    to: str
    light: str
    link: int
    state: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RoadLane:
    """A lane that passenger cars may use.

    Attributes:
        line: (n, 2) centre line, metres.
        width: Metres.
        limit: m/s.
        inside: Whether it is inside a junction.
        junction: Id of the junction at its end; "" inside a junction.
        movements: From its end.
    """

    id: str
    edge: str
    line: Floats
    width: float
    limit: float
    inside: bool
    junction: str
    movements: tuple[Movement, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Town:
    """A network.

    Attributes:
        lanes: Those that passenger cars may use, by SUMO's id.
        junctions: (n, 2) outline of each junction, metres, by id.
    """

    name: str
    lanes: dict[str, RoadLane]
    junctions: dict[str, Floats]


@cache
def read_town(name: str) -> Town:
    """Reads a shipped network."""
    root = ElementTree.parse(_TOWNS / name / f"{name}.net.xml").getroot()
    movements: dict[str, list[Movement]] = {}
    for link in root.iter("connection"):
        start = f"{link.attrib['from']}_{link.attrib['fromLane']}"
        movements.setdefault(start, []).append(
            Movement(
                via=link.get("via", ""),
                to=f"{link.attrib['to']}_{link.attrib['toLane']}",
                light=link.get("tl", ""),
                link=int(link.get("linkIndex", "-1")),
                state=link.get("state", ""),
            )
        )
    lanes = {}
    for edge in root.iter("edge"):
        if edge.get("function") in ("crossing", "walkingarea"):
            continue
        for lane in edge.iter("lane"):
            if not _open_to_cars(lane):
                continue
            key = lane.attrib["id"]
            lanes[key] = RoadLane(
                id=key,
                edge=edge.attrib["id"],
                line=_points(lane.attrib["shape"]),
                width=float(lane.get("width", "3.2")),
                limit=float(lane.attrib["speed"]),
                inside=edge.get("function") == "internal",
                junction=edge.get("to", ""),
                movements=tuple(movements.get(key, ())),
            )
    junctions = {
        junction.attrib["id"]: _points(junction.attrib["shape"])
        for junction in root.iter("junction")
        if junction.get("type") != "internal" and len(junction.get("shape", "").split()) >= 3
    }
    return Town(name=name, lanes=lanes, junctions=junctions)


def _open_to_cars(lane: ElementTree.Element) -> bool:
    allowed, refused = lane.get("allow"), lane.get("disallow")
    if allowed is not None:
        return bool({"passenger", "all"} & set(allowed.split()))
    return refused is None or not {"passenger", "all"} & set(refused.split())


def _points(shape: str) -> Floats:
    return np.array([[float(v) for v in point.split(",")[:2]] for point in shape.split()])


def lane_length(lane: RoadLane) -> float:
    """Returns the length of a lane's centre line, metres."""
    return float(np.hypot(*np.diff(lane.line, axis=0).T).sum())
