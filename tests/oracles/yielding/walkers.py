"""Situations at marked crossings, and one away from them.

At d1 of ``signal-grid`` the crossing of Second Street at x = 392.2 m and that of Garden Street at
y = 7.8 m have no signals; those of d2 have. In ``old-town`` the crossings at the well have none.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.ways import Drive, meeting, steady, straight
from tests.oracles.yielding.paths import pace, way
from tests.oracles.yielding.situation import Pedestrian, Situation, situation

GRID, OLD = "signal-grid", "old-town"

X, STREET = 392.2, -1.62
"""The crossing of Second Street, and the centre of the lane to the east."""

RIGHT = ("grand_3_1", "-garden_1_1")
INTO_GARDEN = ("south_3_1", "garden_1_1")
OUT_OF_GARDEN = ("-garden_1_1", "-south_3_1")
EAST = ("south_3_1", "corner_southeast_1")
GARDEN_GREEN: Mapping[str, Any] = {"junctions": {"d2": {"offset": -29.0}}}
"""Red for all until 1 s, then green for Garden Street until 26 s."""
SLOW = 0.15


def _eastwards(time: float = 6.0, *speeds: tuple[float, float]) -> Drive:
    return meeting(way(GRID, *EAST), (X, STREET), time, *(speeds or ((0.0, 8.0),)))


def _right(time: float) -> Drive:
    return meeting(way(GRID, *RIGHT), (398.4, 99.0), time, (0.0, 5.5))


def _close() -> list[Situation]:
    left = way(GRID, *INTO_GARDEN)
    out = way(GRID, *OUT_OF_GARDEN)
    return [
        situation(
            "walker-on-crossing-halts-before-ego",
            "A pedestrian steps on the crossing from the right and all but halts.",
            GRID,
            _eastwards(),
            Pedestrian(
                steps=((X, -6.9, 1.4), (X, -3.2, 1.4), (X, -2.8, SLOW), (X, 6.0, 1.4)),
                start_time=2.4,
            ),
        ),
        situation(
            "walker-in-mid-crossing-halts-before-ego",
            "A pedestrian comes from the left, all but halts on the middle of the crossing, "
            "and goes on.",
            GRID,
            _eastwards(),
            Pedestrian(
                steps=((X, 5.0, 1.5), (X, 0.6, 1.5), (X, 0.1, SLOW), (X, -6.0, 1.5)), start_time=2.0
            ),
        ),
        situation(
            "walker-on-crossing-steps-back",
            "A pedestrian is on the crossing, and steps back quickly as the ego comes.",
            GRID,
            _eastwards(),
            Pedestrian(
                steps=((X, -5.5, 1.4), (X, -2.8, 1.4), (X, -4.8, 2.5)),
                start_time=2.6,
            ),
        ),
        situation(
            "walker-runs-off-before-ego",
            "A pedestrian on the crossing breaks into a run; the ego passes right behind.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((X, 5.0, 1.4), (X, 0.0, 1.4), (X, -5.0, 3.5)), start_time=0.55),
        ),
        situation(
            "right-turn-before-walker-on-green",
            "The ego turns right on green; a pedestrian on green all but halts before it.",
            GRID,
            _right(7.0),
            Pedestrian(
                steps=(
                    (391.0, 99.0, 1.4),
                    (396.4, 99.0, 1.4),
                    (396.9, 99.0, SLOW),
                    (406.0, 99.0, 1.4),
                ),
                start_time=2.2,
            ),
        ),
        situation(
            "left-turn-before-walker-without-signal",
            "The ego turns left into the side street; a pedestrian on its crossing all but halts.",
            GRID,
            meeting(left, (401.6, 7.8), 7.0, (0.0, 5.0)),
            Pedestrian(
                steps=((393.0, 7.8, 1.4), (399.2, 7.8, 1.4), (399.8, 7.8, SLOW), (408.0, 7.8, 1.4)),
                start_time=1.2,
            ),
        ),
        situation(
            "comes-out-before-walker-without-signal",
            "The ego comes out of the side street over a crossing, close before a pedestrian.",
            GRID,
            meeting(out, (398.4, 7.8), 7.0, (0.0, 5.0)),
            Pedestrian(steps=((405.0, 7.8, 1.5), (393.0, 7.8, 1.5)), start_time=3.95),
        ),
        situation(
            "touches-walker-on-crossing",
            "The ego touches a pedestrian that has crossed half the street at walking speed.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((X, 5.0, 1.4), (X, -6.0, 1.4)), start_time=1.6),
        ),
        situation(
            "one-walker-leaves-and-one-halts",
            "One pedestrian has crossed the ego's lane in good time; a second one all "
            "but halts on the crossing.",
            GRID,
            _eastwards(7.0),
            Pedestrian(steps=((X - 0.8, 5.0, 1.4), (X - 0.8, -6.0, 1.4)), name="first"),
            Pedestrian(
                steps=(
                    (X + 0.6, 5.5, 1.4),
                    (X + 0.6, 0.6, 1.4),
                    (X + 0.6, 0.1, SLOW),
                    (X + 0.6, -5.0, 1.4),
                ),
                name="second",
                start_time=2.2,
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "walker-waits-at-the-kerb",
            "A pedestrian stands on the sidewalk at the crossing all the time.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((X, -4.7, 1.4),)),
        ),
        situation(
            "walker-steps-on-after-ego",
            "A pedestrian steps on the crossing two seconds after the ego has passed.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((382.0, -4.9, 1.4), (X, -4.9, 1.4), (X, 6.0, 1.4))),
        ),
        situation(
            "walker-walks-away-from-egos-lane",
            "A pedestrian on the crossing has left the ego's lane and walks on to the far kerb.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((X, -5.0, 1.4), (X, 6.5, 1.4)), start_time=1.4),
        ),
        situation(
            "stops-for-walker-and-goes-on",
            "The ego stops before the crossing, lets a pedestrian cross, and goes on.",
            GRID,
            _eastwards(12.0, *pace(8.0, (3.2, 3.5, 0.0), (9.0, 2.0, 7.0))),
            Pedestrian(steps=((X, 5.5, 1.4), (X, -6.5, 1.4)), start_time=2.0),
            seconds=17.0,
        ),
        situation(
            "walker-on-red-halts-in-the-middle",
            "The ego has green; a pedestrian that crosses on red all but halts.",
            GRID,
            steady(straight((330.0, 105.12), (440.0, 105.12)), 9.0),
            Pedestrian(
                steps=(
                    (392.8, 114.5, 1.6),
                    (392.8, 107.4, 1.6),
                    (392.8, 106.9, SLOW),
                    (392.8, 101.0, 1.6),
                ),
                start_time=1.4,
            ),
        ),
        situation(
            "walker-on-green-of-the-other-arm",
            "The ego goes straight on; a pedestrian on green crosses the arm beside its way.",
            GRID,
            steady(straight((330.0, 105.12), (440.0, 105.12)), 9.0),
            Pedestrian(
                steps=(
                    (406.5, 99.0, 1.4),
                    (400.5, 99.0, 1.4),
                    (400.0, 99.0, SLOW),
                    (392.0, 99.0, 1.4),
                ),
                start_time=2.6,
            ),
        ),
        situation(
            "walker-passes-along-the-sidewalk",
            "A pedestrian walks along the sidewalk past the crossing, and halts there.",
            GRID,
            _eastwards(),
            Pedestrian(steps=((380.0, -4.9, 1.6), (391.0, -4.9, 1.6)), start_time=0.0),
        ),
        situation(
            "walker-halts-away-from-crossings",
            "Away from any crossing a pedestrian comes into the street and all but halts.",
            GRID,
            steady(straight((300.0, STREET), (440.0, STREET)), 8.0),
            Pedestrian(
                steps=(
                    (345.0, 5.0, 1.4),
                    (345.0, 0.7, 1.4),
                    (345.0, 0.2, SLOW),
                    (345.0, -5.0, 1.4),
                ),
                start_time=2.0,
            ),
        ),
        situation(
            "right-turn-after-walker-has-left-the-lane",
            "The ego turns right on green; a pedestrian has left its lane 2.5 s before.",
            GRID,
            _right(7.5),
            Pedestrian(steps=((393.5, 99.0, 1.5), (407.0, 99.0, 1.5)), start_time=0.2),
        ),
        situation(
            "passes-well-before-walker-far-on-the-crossing",
            "On a street of four lanes a pedestrian sets out at the far kerb as the ego passes.",
            GRID,
            meeting(straight((330.0, 105.12), (450.0, 105.12)), (407.2, 105.12), 8.0, (0.0, 9.0)),
            Pedestrian(steps=((407.2, 118.5, 1.4), (407.2, 100.5, 1.4)), start_time=6.8),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart()]
