"""Situations at right before left and at all-way stops.

In ``old-town`` castle and church are without signs, mill is an all-way stop; others are b1 and d4
of ``signal-grid`` and market_orchard of ``tee-town``.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.yielding.paths import coming, going, pace
from tests.oracles.yielding.situation import Situation, situation

OLD, GRID, TEE = "old-town", "signal-grid", "tee-town"

HILL = ("castle_hill_1", "castle_street_1")
CLOISTER = ("cloister_1", "castle_street_1")
CLOISTER_LANE = ("cloister_1", "castle_lane_1")
STREET_DOWN = ("-castle_street_1", "-castle_hill_1")
CHURCH_ON = ("-west_street_1", "cloister_1")
CHURCH_LANE = ("church_lane_1", "west_street_1")
CHURCH_LEFT = ("church_lane_1", "bakers_1")

SOUTH_WEST = ("-south_2_1", "-corner_southwest_1")
CASTLE_LEFT = ("-castle_1_1", "south_2_1")
CORNER_EAST = ("corner_southwest_1", "south_2_1")
ORCHARD_LEFT = ("-orchard_1_0", "market_2_0")
MARKET_EAST = ("market_1_0", "market_2_0")
MARKET_WEST = ("-market_2_0", "-market_1_0")
MARKET_LEFT = ("market_1_0", "orchard_1_0")
D4_SOUTH = ("north_3_1", "-garden_3_1")
D4_WEST = ("corner_northeast_1", "-north_3_1")
D4_LEFT = ("garden_3_1", "-north_3_1")
D4_UP = ("garden_3_1", "-corner_northeast_1")


def _close() -> list[Situation]:
    return [
        situation(
            "from-the-left-and-car-from-the-right-brakes",
            "At a crossing without signs the ego comes from the left of a car, which brakes hard.",
            OLD,
            going(OLD, CLOISTER, HILL, 8.0, (0.0, 5.0)),
            Car(
                drive=coming(
                    OLD, HILL, CLOISTER, 17.0, 7.0, *pace(8.0, (7.0, 5.0, 1.5), (10.0, 1.5, 6.0))
                )
            ),
        ),
        situation(
            "straight-on-before-car-from-the-right",
            "At a crossing without signs the ego goes straight on; a car from its right stops.",
            OLD,
            going(OLD, CHURCH_ON, CHURCH_LANE, 8.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    OLD,
                    CHURCH_LANE,
                    CHURCH_ON,
                    12.5,
                    7.2,
                    *pace(5.5, (7.2, 4.0, 0.5), (10.0, 1.5, 5.0)),
                )
            ),
        ),
        situation(
            "drives-through-all-way-stop-before-waiting-car",
            "At an all-way stop the ego does not stop; a car that stood first sets out and brakes.",
            GRID,
            going(GRID, SOUTH_WEST, CASTLE_LEFT, 8.0, (0.0, 8.0)),
            Car(
                drive=coming(
                    GRID,
                    CASTLE_LEFT,
                    SOUTH_WEST,
                    5.0,
                    7.4,
                    *pace(5.0, (2.0, 2.5, 0.0), (6.0, 2.0, 2.6), (7.4, 4.0, 0.0), (9.5, 2.0, 5.0)),
                )
            ),
        ),
        situation(
            "second-at-all-way-stop-goes-first",
            "The ego stops as the second one at an all-way stop and sets out first; the car that "
            "was there before it brakes.",
            TEE,
            going(
                TEE, ORCHARD_LEFT, MARKET_WEST, 9.4, *pace(5.0, (4.5, 3.0, 0.0), (6.8, 2.5, 5.0))
            ),
            Car(
                drive=coming(
                    TEE,
                    MARKET_WEST,
                    ORCHARD_LEFT,
                    9.0,
                    8.6,
                    *pace(5.0, (2.0, 2.5, 0.0), (7.2, 2.5, 3.5), (8.6, 4.0, 0.0), (11.5, 2.0, 5.0)),
                )
            ),
            seconds=18.0,
        ),
        situation(
            "enters-all-way-stop-while-car-is-turning-in-it",
            "A car has stopped and turns left in an all-way stop; the ego drives in and it stops.",
            GRID,
            going(GRID, D4_WEST, D4_LEFT, 8.0, (0.0, 7.0)),
            Car(
                drive=coming(
                    GRID,
                    D4_LEFT,
                    D4_WEST,
                    4.0,
                    8.0,
                    *pace(5.0, (1.5, 2.5, 0.0), (5.0, 1.5, 3.6), (7.6, 4.5, 0.0), (10.5, 2.0, 5.0)),
                )
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "from-the-right-and-car-from-the-left-brakes",
            "At a crossing without signs the ego comes from the right of a car, which brakes hard.",
            OLD,
            going(OLD, HILL, CLOISTER, 8.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    OLD, CLOISTER, HILL, 14.0, 7.0, *pace(7.0, (7.0, 5.0, 1.0), (10.0, 1.5, 5.0))
                )
            ),
        ),
        situation(
            "straight-on-long-before-car-from-the-right",
            "At a crossing without signs the ego goes straight on; a car from its right comes four "
            "seconds behind it.",
            OLD,
            going(OLD, CHURCH_ON, CHURCH_LANE, 8.0, (0.0, 7.0)),
            Car(drive=coming(OLD, CHURCH_LANE, CHURCH_ON, 29.0, 8.0, (0.0, 5.5))),
        ),
        situation(
            "first-at-all-way-stop-and-later-car-brakes",
            "The ego has stopped first at an all-way stop and goes; a later car brakes by 4 m/s² "
            "and stops at its own sign.",
            GRID,
            going(GRID, CASTLE_LEFT, SOUTH_WEST, 8.0, *pace(5.0, (2.5, 2.5, 0.0), (5.5, 2.0, 5.0))),
            Car(
                drive=coming(
                    GRID,
                    SOUTH_WEST,
                    CASTLE_LEFT,
                    11.0,
                    9.2,
                    *pace(8.0, (7.2, 4.0, 0.0), (11.0, 2.0, 6.0)),
                )
            ),
            seconds=18.0,
        ),
        situation(
            "all-way-stop-with-opposite-car-straight-on",
            "The ego and an opposite car stop at an all-way stop and both go straight on.",
            TEE,
            going(
                TEE, MARKET_EAST, ORCHARD_LEFT, 9.0, *pace(6.0, (3.5, 3.0, 0.0), (6.5, 2.0, 6.0))
            ),
            Car(
                drive=coming(
                    TEE,
                    MARKET_WEST,
                    ORCHARD_LEFT,
                    5.0,
                    9.2,
                    *pace(6.0, (3.8, 3.8, 0.0), (6.8, 2.0, 6.0)),
                )
            ),
        ),
        situation(
            "right-turn-at-all-way-stop-beside-right-turning-car",
            "At an all-way stop the ego turns right while a car from the other arm turns right.",
            GRID,
            going(
                GRID,
                D4_SOUTH,
                ("corner_northeast_1", "-garden_3_1"),
                9.0,
                *pace(5.0, (3.5, 3.0, 0.0), (6.0, 2.0, 5.0)),
            ),
            Car(
                drive=coming(
                    GRID,
                    D4_UP,
                    ("north_3_1", "-corner_northeast_1"),
                    0.0,
                    9.0,
                    *pace(7.0, (4.2, 4.5, 0.0), (6.5, 2.0, 5.0)),
                )
            ),
        ),
        situation(
            "from-the-left-while-car-from-the-right-turns-off-behind",
            "At a crossing without signs a car from the ego's right brakes and turns left behind "
            "the ego's way.",
            OLD,
            going(OLD, CHURCH_ON, CHURCH_LANE, 8.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    OLD,
                    CHURCH_LEFT,
                    ("-west_street_1", "bakers_1"),
                    0.0,
                    9.5,
                    *pace(5.5, (6.8, 3.5, 3.0)),
                )
            ),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart()]
