"""Situations in which the ego turns left off a road with priority, across the oncoming lane."""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.responsibility.ways import sway
from tests.oracles.yielding.paths import before, coming, going, pace, way
from tests.oracles.yielding.situation import Situation, situation, standing

TEE, ART, RURAL, GRID, HIGH = "tee-town", "arterial", "rural", "signal-grid", "highway"

INTO_MILL = ("harbour_0_0", "mill_1_0")
HARBOUR_WEST = ("-harbour_1_0", "-harbour_0_0")
HARBOUR_IN = ("-harbour_1_0", "mill_1_0")
INTO_GARDEN = ("south_3_1", "garden_1_1")
SECOND_WEST = ("-corner_southeast_1", "-south_3_1")
SECOND_IN = ("-corner_southeast_1", "garden_1_1")
INTO_RIDGE_ROAD = ("valley_17_0", "valley_18_0", "-ridge_2_0")
RIDGE_MAIN = ("-valley_20_0", "-valley_19_0", "-valley_18_0", "-valley_17_0")
INTO_FARM = ("wb_school_pocket_2", "farm_s_0")
FARM_EAST = ("eb_rose_pocket_0", "eb_hill_0", "eb_farm_0", "eb_farm_pocket_0")
FARM_EAST_INNER = ("eb_rose_pocket_1", "eb_hill_1", "eb_farm_1", "eb_farm_pocket_1")
INTO_CHAPEL = ("-south_3_0", "chapel_0")
VILLAGE_EAST = ("south_2_0", "south_3_0")
CHAPEL_IN = ("south_2_0", "chapel_0")


def _close() -> list[Situation]:
    aside = sway(way(GRID, *SECOND_WEST), 196.0, 212.0, -1.6)
    return [
        situation(
            "left-turn-and-oncoming-brakes-hard",
            "The ego turns left; an oncoming car brakes by 6.5 m/s² down to 3 m/s.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_WEST, 7.0, (0.0, 5.0)),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_WEST,
                    INTO_MILL,
                    24.0,
                    6.4,
                    *pace(12.0, (6.4, 6.5, 3.0), (8.6, 2.0, 9.0)),
                )
            ),
        ),
        situation(
            "left-turn-and-oncoming-brakes-moderately",
            "The ego turns left; an oncoming car slows from 10 to 5 m/s by 2.5 m/s².",
            GRID,
            going(GRID, INTO_GARDEN, SECOND_WEST, 7.0, (0.0, 5.0)),
            Car(
                drive=coming(
                    GRID,
                    SECOND_WEST,
                    INTO_GARDEN,
                    24.0,
                    6.0,
                    *pace(10.0, (6.0, 2.5, 5.0), (9.0, 1.5, 8.0)),
                )
            ),
        ),
        situation(
            "left-turn-and-oncoming-passes-half-a-second-later",
            "The ego turns left; an oncoming car passes half a second behind it, unbraked.",
            RURAL,
            going(RURAL, INTO_RIDGE_ROAD, RIDGE_MAIN, 7.0, (0.0, 6.0)),
            Car(drive=coming(RURAL, RIDGE_MAIN, INTO_RIDGE_ROAD, 21.5, 7.0, (0.0, 14.0))),
        ),
        situation(
            "left-turn-and-oncoming-swerves",
            "The ego turns left slowly; an oncoming car swerves to the right round its tail.",
            GRID,
            going(GRID, INTO_GARDEN, SECOND_WEST, 7.0, (0.0, 5.0)),
            Car(drive=before(aside, (402.0, 3.2), 0.0, 8.75, (0.0, 9.0))),
        ),
        situation(
            "left-turn-close-before-oncoming-that-turns-right",
            "The ego turns left into a road; an oncoming car that turns right into it stops.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_IN, 7.0, *pace(4.0, (7.0, 1.0, 6.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_IN,
                    INTO_MILL,
                    14.0,
                    6.3,
                    *pace(7.0, (6.3, 4.5, 0.6), (9.2, 1.5, 5.0)),
                )
            ),
        ),
        situation(
            "left-turn-stops-across-oncoming-lane",
            "The ego stops across the oncoming lane behind a standing car; an oncoming car stops.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_WEST, 6.5, *pace(5.0, (6.2, 3.0, 0.0))),
            Car(
                drive=coming(TEE, HARBOUR_WEST, INTO_MILL, 42.0, 6.6, *pace(11.0, (6.9, 3.6, 0.0)))
            ),
            standing(TEE, INTO_MILL, HARBOUR_WEST, -11.5, name="leader"),
        ),
        situation(
            "left-turn-before-oncoming-truck",
            "The ego turns left in the village; an oncoming truck brakes by 5 m/s² to a stop.",
            HIGH,
            going(HIGH, INTO_CHAPEL, VILLAGE_EAST, 7.0, (0.0, 4.5)),
            Car(
                drive=coming(
                    HIGH,
                    VILLAGE_EAST,
                    INTO_CHAPEL,
                    32.0,
                    6.3,
                    *pace(13.0, (6.3, 5.0, 1.0), (9.6, 1.2, 6.0)),
                ),
                model="vehicle.carlamotors.european_hgv",
            ),
        ),
        situation(
            "left-turn-across-two-lanes-stops-both",
            "The ego turns left across two lanes; in the right one a car brakes by 5 m/s².",
            ART,
            going(ART, INTO_FARM, FARM_EAST, 7.0, (0.0, 5.0)),
            Car(
                drive=coming(
                    ART,
                    FARM_EAST,
                    INTO_FARM,
                    40.0,
                    6.3,
                    *pace(16.0, (6.3, 5.0, 6.0), (9.0, 1.5, 12.0)),
                )
            ),
            Car(
                drive=coming(
                    ART,
                    FARM_EAST_INNER,
                    INTO_FARM,
                    60.0,
                    5.5,
                    *pace(16.0, (5.5, 4.2, 8.0), (9.0, 1.5, 12.0)),
                ),
                name="inner",
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "left-turn-and-oncoming-passes-four-seconds-later",
            "The ego turns left; an oncoming car passes the place four seconds later.",
            RURAL,
            going(RURAL, INTO_RIDGE_ROAD, RIDGE_MAIN, 7.0, (0.0, 6.0)),
            Car(drive=coming(RURAL, RIDGE_MAIN, INTO_RIDGE_ROAD, 70.0, 7.0, (0.0, 14.0))),
        ),
        situation(
            "left-turn-with-oncoming-far-and-standing-car",
            "The ego turns left; 80 m away an oncoming car brakes hard for a standing one.",
            HIGH,
            going(HIGH, INTO_CHAPEL, VILLAGE_EAST, 7.0, (0.0, 5.5)),
            Car(
                drive=coming(
                    HIGH, VILLAGE_EAST, INTO_CHAPEL, 95.0, 7.0, *pace(14.0, (7.2, 5.5, 0.0))
                )
            ),
            standing(HIGH, VILLAGE_EAST, INTO_CHAPEL, 62.0, name="leader"),
        ),
        situation(
            "left-turn-and-oncoming-turns-right-after-it",
            "The ego turns left; an oncoming car turns right four seconds behind it.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_IN, 7.0, *pace(5.0, (7.0, 1.5, 8.0))),
            Car(drive=coming(TEE, HARBOUR_IN, INTO_MILL, 34.0, 7.0, *pace(11.0, (7.3, 3.6, 5.0)))),
        ),
        situation(
            "left-turn-waits-for-two-oncoming",
            "The ego waits in the junction until two oncoming cars have passed, and turns left.",
            GRID,
            going(
                GRID, INTO_GARDEN, SECOND_WEST, 13.4, *pace(5.0, (4.5, 2.5, 0.0), (10.4, 2.0, 5.0))
            ),
            Car(drive=coming(GRID, SECOND_WEST, INTO_GARDEN, 0.0, 7.2, (0.0, 9.0))),
            Car(drive=coming(GRID, SECOND_WEST, INTO_GARDEN, 0.0, 9.4, (0.0, 9.0)), name="second"),
            seconds=19.0,
        ),
        situation(
            "left-turn-and-oncoming-brakes-after-it",
            "The ego turns left; two and a half seconds after it has gone, a car brakes 45 m away.",
            HIGH,
            going(HIGH, INTO_CHAPEL, VILLAGE_EAST, 6.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    HIGH, VILLAGE_EAST, INTO_CHAPEL, 45.0, 10.5, *pace(13.0, (10.5, 5.0, 2.0))
                )
            ),
            seconds=17.0,
        ),
        situation(
            "left-turn-and-oncoming-leader-turns-right",
            "The ego turns left after an oncoming car has turned in; the one behind that brakes "
            "for it 45 m away.",
            HIGH,
            going(HIGH, INTO_CHAPEL, CHAPEL_IN, 9.2, (0.0, 4.8)),
            Car(
                drive=coming(HIGH, CHAPEL_IN, INTO_CHAPEL, 0.0, 6.2, *pace(12.0, (2.6, 3.0, 5.0))),
                name="leader",
            ),
            Car(
                drive=coming(
                    HIGH,
                    VILLAGE_EAST,
                    INTO_CHAPEL,
                    62.0,
                    4.9,
                    *pace(13.0, (4.9, 4.0, 5.5), (9.5, 1.5, 12.0)),
                )
            ),
        ),
        situation(
            "left-turn-with-oncoming-in-the-lane-behind-a-truck",
            "The ego turns left after a truck has passed; a car 40 m behind the truck keeps 8 m/s.",
            GRID,
            going(GRID, INTO_GARDEN, SECOND_WEST, 9.6, (0.0, 5.5)),
            Car(
                drive=coming(GRID, SECOND_WEST, INTO_GARDEN, 0.0, 7.0, (0.0, 8.0)),
                name="leader",
                model="vehicle.carlamotors.firetruck",
            ),
            Car(drive=coming(GRID, SECOND_WEST, INTO_GARDEN, 36.0, 9.6, (0.0, 8.0))),
        ),
        situation(
            "passes-straight-while-oncoming-left-turner-brakes",
            "The ego goes straight on; an oncoming car that turns left brakes hard and stops.",
            TEE,
            going(TEE, HARBOUR_WEST, INTO_MILL, 7.0, (0.0, 11.0)),
            Car(
                drive=coming(
                    TEE,
                    INTO_MILL,
                    HARBOUR_WEST,
                    13.0,
                    5.6,
                    *pace(8.0, (5.6, 4.5, 0.5), (9.0, 2.0, 5.0)),
                )
            ),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart()]
