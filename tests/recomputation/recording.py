"""A trace as its Parquet file has it, read with pyarrow and NumPy alone.

What is where stands in ``docs/reference/trace.md``.
"""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

STATE = ("x", "y", "yaw", "vx", "vy", "ax", "ay", "yaw_rate", "z")
EGO = ("lane", "light", "ego_light_distance", "ego_route_s", "ego_speed_limit")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """An ego's own part of a run: n rows from its start time to the end of its part.

    Attributes:
        actor: Index of the ego.
        first: Step of the first row.
        x, y, z: (n,) metres.
        yaw: (n,) radians.
        vx, vy: (n,) m/s.
        ax, ay: (n,) m/s².
        yaw_rate: (n,) rad/s.
        speed: (n,) m/s over ground.
        moved: (n,) metres since the row before.
        lanes: SUMO's id of the lane in each row, "" off every lane.
        route_s: (n,) metres along the route, as recorded.
        speed_limit: (n,) m/s as recorded, NaN where none is.
        light: (n,) what the next signal on the route shows, as recorded: 2 yellow, 3 red.
        light_distance: (n,) metres from the front to its line, NaN where there is none.
        line: (m, 2) the route's reference line, metres.
        arc: (m,) metres along it.
        goal: x and y of the destination, metres.
    """

    actor: int
    id: str
    length: float
    width: float
    start_time: float
    end: str
    first: int
    x: Floats
    y: Floats
    z: Floats
    yaw: Floats
    vx: Floats
    vy: Floats
    ax: Floats
    ay: Floats
    yaw_rate: Floats
    speed: Floats
    moved: Floats
    lanes: tuple[str, ...]
    route_s: Floats
    speed_limit: Floats
    light: Floats
    light_distance: Floats
    line: Floats
    arc: Floats
    goal: tuple[float, float]

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.x)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """A run.

    Attributes:
        head: The metadata.
        states: (steps, actors) of each column of ``STATE``; NaN where not present.
        drives: The egos' parts.
        rows: Rows of the table.
    """

    head: dict[str, Any]
    states: dict[str, Floats]
    drives: tuple[Drive, ...]
    rows: int

    @property
    def step_length(self) -> float:
        """Seconds."""
        return float(self.head["step_length"])

    def signal(self, light: str, link: int) -> list[str]:
        """Returns SUMO's letter of a signal at every step."""
        changes = self.head["lights"]["changes"][light]
        names = self.head["lights"]["states"]
        ends = [step for step, _ in changes[1:]] + [int(self.head["steps"])]
        letters: list[str] = []
        for (_, state), end in zip(changes, ends, strict=True):
            letters += [names[state][link]] * (end - len(letters))
        return letters


def read_recording(path: Path) -> Recording:
    """Reads a trace file."""
    table = pq.read_table(path)
    head = json.loads(table.schema.metadata[b"drivora_trace"])
    shape = (int(head["steps"]), len(head["actors"]))
    places = (table.column("step").to_numpy(), table.column("actor").to_numpy())

    def spread(name: str) -> Floats:
        values = np.full(shape, np.nan)
        column = table.column(name).cast(pa.float64()).to_numpy(zero_copy_only=False)
        values[places] = column
        return values

    states = {name: spread(name) for name in STATE}
    own = {name: spread(name) for name in EGO}
    return Recording(
        head=head,
        states=states,
        drives=tuple(_drive(head, states, own, ego) for ego in range(len(head["egos"]))),
        rows=table.num_rows,
    )


def _drive(
    head: dict[str, Any], states: dict[str, Floats], own: dict[str, Floats], ego: int
) -> Drive:
    facts, actor = head["egos"][ego], head["actors"][ego]
    times = np.arange(int(head["steps"])) * float(head["step_length"])
    rows = np.flatnonzero(times >= facts["start_time"] - 1e-9)
    rows = rows[rows <= facts["end_step"]]
    absent = np.isnan(states["x"][rows, ego])
    if absent.any():
        rows = rows[: int(np.argmax(absent))]
    x, y = states["x"][rows, ego], states["y"][rows, ego]
    lane_ids = {int(index): name for index, name in head["lane_ids"].items()}
    lanes = own["lane"][rows, ego]
    route = facts["route"]
    return Drive(
        actor=ego,
        id=actor["id"],
        length=actor["length"],
        width=actor["width"],
        start_time=facts["start_time"],
        end=facts["end"],
        first=int(rows[0]) if len(rows) else 0,
        x=x,
        y=y,
        z=states["z"][rows, ego],
        yaw=states["yaw"][rows, ego],
        vx=states["vx"][rows, ego],
        vy=states["vy"][rows, ego],
        ax=states["ax"][rows, ego],
        ay=states["ay"][rows, ego],
        yaw_rate=states["yaw_rate"][rows, ego],
        speed=np.hypot(states["vx"][rows, ego], states["vy"][rows, ego]),
        moved=np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1])),
        lanes=tuple("" if np.isnan(lane) else lane_ids[int(lane)] for lane in lanes),
        route_s=own["ego_route_s"][rows, ego],
        speed_limit=own["ego_speed_limit"][rows, ego],
        light=own["light"][rows, ego],
        light_distance=own["ego_light_distance"][rows, ego],
        line=_doubles(route["line_f8"]).reshape(-1, 2),
        arc=_doubles(route["arc_f8"]),
        goal=(route["goal"][0], route["goal"][1]),
    )


def _doubles(text: str) -> Floats:
    return np.frombuffer(base64.b64decode(text), dtype="<f8").astype(np.float64)
