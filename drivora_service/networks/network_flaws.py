"""Checks for invalid networks: coordinates that are not finite, lanes without a line, and others.

Such files are well-formed, and SUMO's own reader accepts them. Code that uses a network assumes
that it has no such flaw.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drivora_service.errors import NetworkError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import Lane, SignalProgram

MAX_COORDINATE = 1e8
"""Metres; twice the circumference of the Earth."""

MAX_AREA = 2.5e9
"""Square metres of the rectangle around all lanes, whose grid has to fit into memory. Greater
Berlin takes 1.7e9."""

MAX_LANE_WIDTH = 100.0
"""Metres."""


def check_numbers(what: str, values: ArrayLike) -> None:
    """Checks coordinates or lengths.

    Raises:
        NetworkError: One is not finite, or too large.
    """
    numbers = np.ravel(np.asarray(values, dtype=np.float64))
    wrong = numbers[~(np.abs(numbers) <= MAX_COORDINATE)]
    if len(wrong):
        raise NetworkError(
            f"found {wrong[0]:g} in {what}; finite numbers up to {MAX_COORDINATE:g} m are allowed"
        )


def read_line(source: Any, lane_id: str) -> FloatArray:
    """Returns the (n, 2) points of a lane as sumolib read it, metres.

    Raises:
        NetworkError: It has no points, or one that is not finite.
    """
    shape = source.getShape()
    if not shape:
        raise NetworkError(f"lane {lane_id!r} has no shape; give the points of its centre line")
    check_numbers(
        f"the shape of lane {lane_id!r}", [value for p in source.getShape3D() for value in p]
    )
    return np.asarray(shape, dtype=np.float64).reshape(-1, 2)


def check_lanes(lanes: Iterable[tuple[str, FloatArray, Any]]) -> None:
    """Checks lanes, each given by its id, its points and sumolib's object.

    Raises:
        NetworkError: One has no usable length, width or speed limit, an id is repeated, or all
            of them together cover too large an area.
    """
    known: set[str] = set()
    lines = []
    for lane_id, points, source in lanes:
        if lane_id in known:
            raise NetworkError(f"found lane {lane_id!r} again; ids must be unique")
        known.add(lane_id)
        lines.append(points)
        check_numbers(f"lane {lane_id!r}", (source.getLength(), source.getWidth()))
        for what, value, limit in (
            ("length", source.getLength(), MAX_COORDINATE),
            ("width", source.getWidth(), MAX_LANE_WIDTH),
            ("speed", source.getSpeed(), MAX_COORDINATE),
        ):
            if not 0.0 < value <= limit:
                raise NetworkError(
                    f"lane {lane_id!r} has a {what} of {value:g}; more than 0 and at most "
                    f"{limit:g} is allowed"
                )
    if not lines:
        raise NetworkError("found no lane: it is empty, or not a SUMO network")
    places = np.concatenate(lines)
    width, height = np.ptp(places, axis=0)
    if width * height > MAX_AREA:
        raise NetworkError(
            f"its lanes spread over {width / 1e3:.0f} km by {height / 1e3:.0f} km; at most "
            f"{MAX_AREA / 1e6:.0f} km² are allowed: cut out the part that is needed"
        )


def check_signals(programs: Mapping[str, SignalProgram], lanes: Iterable[Lane]) -> None:
    """Checks signal programmes, and that every connection with a signal has one in them.

    Raises:
        NetworkError: A programme has no phase, no duration, or phases for different numbers of
            signals; or a connection names a missing signal.
    """
    for program in programs.values():
        times = [phase.duration for phase in program.phases]
        check_numbers(f"traffic light {program.id!r}", (program.offset, *times))
        if not times or min(times) < 0.0 or sum(times) <= 0.0:
            raise NetworkError(
                f"traffic light {program.id!r} has no phases of more than 0 s together"
            )
        if len({len(phase.state) for phase in program.phases}) > 1:
            raise NetworkError(
                f"traffic light {program.id!r} has phases for different numbers of signals"
            )
    for lane in lanes:
        for link in lane.connections:
            if not link.traffic_light:
                continue
            known = programs.get(link.traffic_light)
            signals = 0 if known is None else len(known.phases[0].state)
            if not 0 <= link.link_index < signals:
                raise NetworkError(
                    f"a connection of lane {lane.id!r} has signal {link.link_index} of traffic "
                    f"light {link.traffic_light!r}, which has {signals}"
                )
