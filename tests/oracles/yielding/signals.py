"""Situations at signals.

In ``signal-grid`` d2 (400, 110) has green for Grand Street until 25 s, c2 likewise; in ``arterial``
hill has green for the arterial road until 28 s, with left turns that must give way, and from 32 to
38 s green for those left turns alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import Car
from tests.oracles.yielding.paths import coming, going, pace
from tests.oracles.yielding.situation import Situation, situation, standing

GRID, ART, TEE = "signal-grid", "arterial", "tee-town"

GRAND_LEFT = ("grand_3_2", "garden_2_1")
GRAND_RIGHT = ("grand_3_1", "-garden_1_1")
GRAND_EAST = ("grand_3_2", "grand_4_2")
GRAND_WEST = ("-grand_4_1", "-grand_3_1")
GRAND_WEST_LEFT = ("-grand_4_2", "-garden_1_1")
GARDEN_UP = ("garden_1_1", "garden_2_1")
GARDEN_LONG = ("south_3_1", "garden_1_1", "garden_2_1")
GARDEN_RIGHT = ("garden_1_1", "grand_4_1")
GRAND_EAST_RIGHT = ("grand_3_1", "grand_4_1")
HILL_LEFT = ("wb_farm_pocket_2", "hill_s_0")
HILL_EAST = ("eb_station_0", "eb_rose_0", "eb_rose_pocket_0", "eb_hill_0")
FERRY_LEFT = ("-high_4_0", "-ferry_1_0")
HIGH_EAST = ("high_2_0", "high_3_0", "high_4_0")

BOXED: Mapping[str, Any] = {"junctions": {"d2": {"offset": -20.0}}}
"""Green for Grand Street until 5 s, yellow until 8 s, green for Garden Street from 10 s."""
PROTECTED: Mapping[str, Any] = {"junctions": {"hill": {"offset": -30.0}}}
"""Yellow for the arterial road until 2 s, green for left turns from 2 to 8 s."""
ENDING: Mapping[str, Any] = {"junctions": {"hill": {"offset": -20.0}}}
"""Green for the arterial road until 8 s, yellow until 12 s."""


def _close() -> list[Situation]:
    return [
        situation(
            "left-on-green-and-oncoming-brakes-hard",
            "Both have green; the ego turns left, and an oncoming car brakes by 6 m/s².",
            GRID,
            going(GRID, GRAND_LEFT, GRAND_WEST, 7.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    GRID,
                    GRAND_WEST,
                    GRAND_LEFT,
                    30.0,
                    6.2,
                    *pace(13.0, (6.2, 6.0, 3.0), (8.6, 2.0, 10.0)),
                )
            ),
        ),
        situation(
            "drives-on-red-and-crossing-car-brakes",
            "The ego crosses on red; a car that has green brakes by 5 m/s².",
            GRID,
            going(GRID, GARDEN_UP, GRAND_WEST, 7.0, (0.0, 8.0)),
            Car(
                drive=coming(
                    GRID,
                    GRAND_WEST,
                    GARDEN_UP,
                    27.0,
                    5.8,
                    *pace(12.0, (5.8, 5.0, 4.0), (8.0, 2.0, 10.0)),
                )
            ),
        ),
        situation(
            "right-on-red-before-car-on-green",
            "The ego turns right on red into the street; a car on green behind it brakes hard.",
            GRID,
            going(GRID, GARDEN_RIGHT, GRAND_EAST_RIGHT, 7.0, *pace(5.0, (7.0, 1.0, 9.0))),
            Car(
                drive=coming(
                    GRID,
                    GRAND_EAST_RIGHT,
                    GARDEN_RIGHT,
                    24.0,
                    6.5,
                    *pace(12.0, (6.5, 4.5, 4.5), (9.0, 1.0, 8.0)),
                )
            ),
        ),
        situation(
            "stands-in-the-box-when-cross-street-has-green",
            "The ego enters at the end of green and stops behind a queue in the junction; a car "
            "whose green has begun brakes and stops before it.",
            GRID,
            going(GRID, GRAND_EAST, GARDEN_UP, 6.5, *pace(7.0, (5.4, 3.2, 0.0))),
            standing(GRID, GRAND_EAST, GARDEN_UP, -8.3, name="leader"),
            Car(
                drive=coming(
                    GRID, GARDEN_LONG, GRAND_EAST, 27.0, 12.6, *pace(9.0, (12.8, 3.8, 0.0))
                )
            ),
            lights=BOXED,
            seconds=20.0,
        ),
        situation(
            "left-on-green-before-bus-in-tee-town",
            "The ego turns left on a green that it shares; an oncoming bus brakes by 4 m/s².",
            TEE,
            going(TEE, FERRY_LEFT, HIGH_EAST, 7.0, (0.0, 4.5)),
            Car(
                drive=coming(
                    TEE,
                    HIGH_EAST,
                    FERRY_LEFT,
                    26.0,
                    6.3,
                    *pace(10.0, (6.3, 4.0, 1.5), (9.5, 1.2, 7.0)),
                ),
                model="vehicle.mitsubishi.fusorosa",
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "left-on-its-own-green-while-oncoming-brakes-at-red",
            "The ego turns left on a green of its own; an oncoming car brakes by 4.5 m/s² for red.",
            ART,
            going(ART, HILL_LEFT, HILL_EAST, 6.0, (0.0, 6.0)),
            Car(drive=coming(ART, HILL_EAST, HILL_LEFT, 46.0, 4.6, *pace(15.0, (4.6, 4.5, 0.0)))),
            lights=PROTECTED,
        ),
        situation(
            "left-on-green-while-oncoming-brakes-at-yellow",
            "The ego turns left on green; 60 m away an oncoming car brakes for its yellow.",
            ART,
            going(ART, HILL_LEFT, HILL_EAST, 8.0, (0.0, 7.0)),
            Car(drive=coming(ART, HILL_EAST, HILL_LEFT, 62.0, 8.6, *pace(16.0, (8.6, 3.8, 0.0)))),
            lights=ENDING,
        ),
        situation(
            "crosses-on-green-while-crossing-car-brakes-at-red",
            "The ego crosses on green; a car from the side brakes by 5 m/s² at its red.",
            GRID,
            going(GRID, GRAND_EAST, GARDEN_UP, 7.0, (0.0, 10.0)),
            Car(drive=coming(GRID, GARDEN_UP, GRAND_EAST, 25.0, 6.2, *pace(10.0, (6.2, 5.0, 0.0)))),
        ),
        situation(
            "crosses-on-green-while-car-runs-its-red-and-brakes",
            "The ego crosses on green; a car from the side enters on red and brakes before it.",
            GRID,
            going(GRID, GRAND_EAST, GARDEN_UP, 7.0, (0.0, 10.0)),
            Car(
                drive=coming(
                    GRID,
                    GARDEN_UP,
                    GRAND_EAST,
                    14.0,
                    6.0,
                    *pace(9.0, (6.0, 5.5, 1.0), (8.5, 2.0, 8.0)),
                )
            ),
        ),
        situation(
            "straight-on-green-while-oncoming-left-turner-brakes",
            "Both have green; the ego goes straight on, and a left-turning car brakes.",
            GRID,
            going(GRID, GRAND_EAST_RIGHT, GRAND_WEST_LEFT, 7.0, (0.0, 11.0)),
            Car(
                drive=coming(
                    GRID,
                    GRAND_WEST_LEFT,
                    GRAND_EAST_RIGHT,
                    12.5,
                    6.0,
                    *pace(9.0, (6.0, 5.0, 0.5), (8.2, 2.0, 6.0)),
                )
            ),
        ),
        situation(
            "right-on-green-while-oncoming-left-turner-waits",
            "Both have green; the ego turns right, and a left-turning car slows behind it.",
            GRID,
            going(GRID, GRAND_RIGHT, GRAND_WEST_LEFT, 7.0, *pace(5.0, (7.0, 1.0, 7.0))),
            Car(
                drive=coming(
                    GRID,
                    GRAND_WEST_LEFT,
                    GRAND_RIGHT,
                    21.0,
                    6.0,
                    *pace(9.0, (6.0, 4.0, 3.0), (9.0, 1.5, 6.0)),
                )
            ),
        ),
        situation(
            "left-turn-opposite-left-turn",
            "The ego and an oncoming car both turn left and pass each other; that car brakes.",
            ART,
            going(ART, HILL_LEFT, HILL_EAST, 7.0, (0.0, 5.5)),
            Car(
                drive=going(
                    ART,
                    ("eb_rose_pocket_2", "hill_n_0"),
                    ("wb_farm_pocket_0", "wb_hill_0"),
                    7.6,
                    *pace(11.0, (4.0, 3.8, 5.0)),
                )
            ),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart()]
