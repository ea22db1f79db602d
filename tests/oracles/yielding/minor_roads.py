"""Situations in which the ego comes out of a road that must give way.

In ``tee-town`` Mill Road meets Harbour Street at harbour_mill and Ferry Road at harbour_ferry; in
``rural`` Ridge Road meets the valley road at ridge_south; in ``arterial`` Rose, Mill and Farm
Street come out at the arterial road; in ``highway`` exit ramps end at stop signs.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.responsibility.ways import Drive, sway
from tests.oracles.yielding.paths import before, coming, going, pace, way, where
from tests.oracles.yielding.situation import Situation, situation, standing

TEE, ART, RURAL, HIGH, OLD = "tee-town", "arterial", "rural", "highway", "old-town"

OUT_LEFT = ("-mill_1_0", "harbour_1_0")
OUT_RIGHT = ("-mill_1_0", "-harbour_0_0")
FROM_LEFT = ("harbour_0_0", "harbour_1_0")
FROM_RIGHT = ("-harbour_1_0", "-harbour_0_0")
FERRY_LEFT = ("-ferry_1_0", "harbour_2_0")
FERRY_MAIN = ("-harbour_2_0", "-harbour_1_0")
RIDGE_LEFT = ("-ridge_1_0", "valley_7_0", "valley_8_0")
RIDGE_RIGHT = ("-ridge_1_0", "-valley_6_0", "-valley_5_0")
VALLEY_WEST = ("-valley_8_0", "-valley_7_0", "-valley_6_0", "-valley_5_0")
VALLEY_EAST = ("valley_5_0", "valley_6_0", "valley_7_0", "valley_8_0")
ROSE = ("-rose_s_0", "eb_rose_0", "eb_rose_pocket_0")
STATION = ("eb_mill_pocket_0", "eb_station_0", "eb_rose_0", "eb_rose_pocket_0")
MILL_LEFT = ("-mill_n_0", "eb_mill_1", "eb_mill_pocket_1")
MILL_RIGHT = ("-mill_n_0", "wb_mill_0")
MILL_WEST = ("wb_hill_pocket_0", "wb_station_0", "wb_mill_0")
MILL_WEST_INNER = ("wb_hill_pocket_1", "wb_station_1", "wb_mill_1")
FARM_LEFT = ("-farm_s_0", "wb_farm_1", "wb_farm_pocket_1")
FARM_EAST = ("eb_hill_0", "eb_farm_0", "eb_farm_pocket_0")
RAMP_LEFT = ("eb_a_exit_ramp_0", "south_1_0")
RAMP_RIGHT = ("eb_a_exit_ramp_0", "west_round_0")
TERMINAL_WEST = ("-south_1_0", "west_round_0")
WALL = ("wall_4_1", "wall_5_1", "wall_6_1")
GATE = ("west_street_1", "wall_5_1", "wall_6_1")

START = pace(0.0, (3.5, 2.5, 7.0))
"""From a standstill at the line."""


def _close() -> list[Situation]:
    swerving = sway(way(HIGH, *TERMINAL_WEST)[:60], 316.0, 340.0, -2.7)
    return [
        situation(
            "out-left-and-car-brakes-hard",
            "The ego turns left out of the minor road; a car from the right brakes by 6 m/s².",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 7.0, (0.0, 5.0)),
            Car(
                drive=coming(
                    TEE,
                    FROM_RIGHT,
                    OUT_LEFT,
                    30.0,
                    6.0,
                    *pace(12.0, (6.0, 6.0, 2.0), (8.8, 2.0, 9.0)),
                )
            ),
        ),
        situation(
            "out-left-and-car-brakes-moderately",
            "The ego turns left on to the valley road; a car from the left brakes by 3 m/s².",
            RURAL,
            going(RURAL, RIDGE_LEFT, VALLEY_WEST, 7.0, *pace(5.0, (6.8, 2.0, 11.0))),
            Car(
                drive=coming(
                    RURAL,
                    VALLEY_WEST,
                    RIDGE_LEFT,
                    48.0,
                    5.8,
                    *pace(16.0, (5.8, 3.0, 8.5), (8.8, 1.5, 14.0)),
                )
            ),
        ),
        situation(
            "out-right-close-before-fast-car",
            "The ego turns right from the side street 30 m ahead of a fast car, which brakes hard.",
            ART,
            going(ART, ROSE, STATION, 7.0, *pace(5.0, (7.0, 1.5, 12.0))),
            Car(
                drive=coming(
                    ART, STATION, ROSE, 34.0, 6.6, *pace(16.0, (6.6, 5.5, 6.0), (9.5, 1.2, 11.0))
                )
            ),
        ),
        situation(
            "out-left-and-car-arrives-half-a-second-later",
            "The ego turns left; a car passes behind it half a second later at constant speed.",
            TEE,
            going(TEE, FERRY_LEFT, FERRY_MAIN, 7.0, (0.0, 6.0)),
            Car(drive=coming(TEE, FERRY_MAIN, FERRY_LEFT, 19.0, 7.0, (0.0, 11.0))),
        ),
        situation(
            "out-left-and-truck-arrives-a-second-later",
            "The ego turns left at the stop sign; a truck passes behind it a second later.",
            ART,
            going(ART, MILL_LEFT, MILL_WEST, 7.0, *START),
            Car(
                drive=coming(ART, MILL_WEST, MILL_LEFT, 28.5, 7.0, (0.0, 14.0)),
                model="vehicle.carlamotors.european_hgv",
            ),
        ),
        situation(
            "out-left-and-car-swerves-round",
            "The ego turns left from the ramp; a car swerves to its right behind its tail.",
            HIGH,
            going(HIGH, RAMP_LEFT, TERMINAL_WEST, 7.0, (0.0, 4.5)),
            Car(drive=before(swerving, (790.0, -175.5), 0.0, 8.0, (0.0, 13.0))),
        ),
        situation(
            "out-left-and-car-touches-tail",
            "The ego turns left from the farm road; a car brakes hard and still touches its tail.",
            ART,
            going(ART, FARM_LEFT, FARM_EAST, 7.0, (0.0, 4.5)),
            Car(drive=coming(ART, FARM_EAST, FARM_LEFT, 20.0, 6.5, *pace(15.0, (6.7, 4.0, 9.0)))),
        ),
        situation(
            "nose-in-the-lane-stops-car",
            "The ego comes out, stops with its nose in the lane, and a car stops before it.",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 6.5, *pace(5.0, (5.3, 4.0, 0.0), (14.0, 2.0, 6.0))),
            Car(
                drive=coming(
                    TEE,
                    FROM_RIGHT,
                    OUT_LEFT,
                    34.0,
                    6.5,
                    *pace(11.0, (6.5, 4.2, 1.0), (16.0, 2.0, 8.0)),
                )
            ),
            seconds=20.0,
        ),
        situation(
            "out-right-before-car-from-ramp-speed",
            "The ego turns right from the ramp; a car at 19 m/s brakes by 4 m/s² behind it.",
            HIGH,
            going(HIGH, RAMP_RIGHT, TERMINAL_WEST, 7.0, *pace(5.0, (7.0, 1.8, 15.0))),
            Car(
                drive=coming(
                    HIGH, TERMINAL_WEST, RAMP_RIGHT, 52.0, 6.4, *pace(19.0, (6.4, 4.0, 8.0))
                )
            ),
        ),
        situation(
            "out-left-before-motorcycle-that-brakes",
            "The ego turns left at the town wall; a motorcycle from the left brakes to a stop.",
            OLD,
            going(OLD, GATE, WALL, 7.0, *pace(4.0, (7.0, 1.0, 6.0))),
            Car(
                drive=coming(
                    OLD, WALL, GATE, 24.0, 6.2, *pace(10.0, (6.2, 4.5, 1.5), (9.5, 1.5, 6.0))
                ),
                model="vehicle.kawasaki.ninja",
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "out-left-and-car-arrives-four-seconds-later",
            "The ego turns left; a car from the right passes the place four seconds later.",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 7.0, (0.0, 6.0)),
            Car(drive=coming(TEE, FROM_RIGHT, OUT_LEFT, 55.0, 7.0, (0.0, 11.0))),
        ),
        situation(
            "out-left-and-car-arrives-two-seconds-later",
            "The ego turns left; a car from the left passes the place two seconds later.",
            RURAL,
            going(RURAL, RIDGE_LEFT, VALLEY_WEST, 7.0, *pace(6.0, (6.8, 2.0, 11.0))),
            Car(drive=coming(RURAL, VALLEY_WEST, RIDGE_LEFT, 41.5, 7.0, (0.0, 14.0))),
        ),
        situation(
            "out-right-with-fast-car-far-behind",
            "The ego turns right and speeds up; a car 105 m behind eases off by 1 m/s².",
            ART,
            going(ART, ROSE, STATION, 7.0, *pace(6.0, (6.5, 2.0, 14.0))),
            Car(drive=coming(ART, STATION, ROSE, 105.0, 7.0, *pace(15.0, (8.0, 1.0, 13.0)))),
        ),
        situation(
            "out-left-while-car-stands-on-the-main-road",
            "The ego turns left; a car has stood on the main road 25 m away all the time.",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 7.0, (0.0, 5.0)),
            standing(TEE, FROM_RIGHT, OUT_LEFT, 22.0),
        ),
        situation(
            "out-left-while-car-creeps-on-the-main-road",
            "The ego turns left; a car on the main road creeps at 1.5 m/s, 18 m away.",
            TEE,
            going(TEE, FERRY_LEFT, FERRY_MAIN, 7.0, (0.0, 6.0)),
            Car(drive=coming(TEE, FERRY_MAIN, FERRY_LEFT, 20.0, 7.0, (0.0, 1.5))),
        ),
        situation(
            "waits-in-the-mouth-and-lets-car-pass",
            "The ego stops in the mouth of the minor road, lets a car pass, and turns left.",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 10.5, *pace(5.0, (4.0, 2.5, 0.0), (8.6, 2.0, 6.0))),
            Car(drive=coming(TEE, FROM_RIGHT, OUT_LEFT, 0.0, 7.6, (0.0, 11.0))),
            seconds=18.0,
        ),
        situation(
            "out-right-while-car-in-the-other-lane-brakes",
            "The ego turns right into the right lane; a car in the left lane brakes by 4 m/s².",
            ART,
            going(ART, MILL_RIGHT, MILL_WEST, 7.0, *pace(5.0, (7.0, 2.0, 12.0))),
            Car(
                drive=before(
                    way(ART, *MILL_WEST_INNER),
                    where(way(ART, *MILL_WEST), way(ART, *MILL_RIGHT)),
                    40.0,
                    6.5,
                    *pace(15.0, (6.5, 4.0, 9.0), (9.0, 1.5, 12.0)),
                )
            ),
        ),
        situation(
            "out-right-while-car-turns-in",
            "The ego turns right out; a car from the right brakes and turns right into that road.",
            TEE,
            going(TEE, OUT_RIGHT, FROM_RIGHT, 7.0, (0.0, 5.0)),
            Car(drive=_turning_in()),
        ),
        situation(
            "out-right-and-two-cars-far-behind",
            "The ego turns right; 75 m away a car brakes by 4.5 m/s² for a slower one ahead of it.",
            ART,
            going(ART, ROSE, STATION, 7.0, *pace(6.0, (6.8, 2.2, 15.0))),
            Car(drive=coming(ART, STATION, ROSE, 78.0, 7.0, *pace(15.0, (7.0, 4.5, 7.5)))),
            Car(drive=coming(ART, STATION, ROSE, 52.0, 7.0, (0.0, 7.0)), name="leader"),
        ),
        situation(
            "out-left-and-car-has-braked-long-before",
            "A car stops on the main road 50 m away before the ego reaches it; the ego turns left.",
            RURAL,
            going(RURAL, RIDGE_LEFT, VALLEY_WEST, 9.5, *pace(6.0, (9.0, 2.0, 11.0))),
            Car(
                drive=coming(
                    RURAL,
                    VALLEY_WEST,
                    RIDGE_LEFT,
                    85.0,
                    2.0,
                    *pace(15.0, (2.0, 4.5, 0.0), (13.5, 2.0, 10.0)),
                )
            ),
            seconds=20.0,
        ),
        situation(
            "out-left-and-car-brakes-after-ego-has-gone",
            "The ego turns left; five seconds after it has gone, a car brakes by 5 m/s² and stops.",
            TEE,
            going(TEE, OUT_LEFT, FROM_RIGHT, 5.0, (0.0, 6.0)),
            Car(drive=coming(TEE, FROM_RIGHT, OUT_LEFT, 28.0, 11.0, *pace(9.0, (11.0, 5.0, 0.0)))),
            seconds=18.0,
        ),
    ]


def _turning_in() -> Drive:
    line = way(TEE, "-harbour_1_0", "mill_1_0")
    return before(line, (137.0, 3.5), 0.0, 7.4, *pace(11.0, (4.9, 3.8, 4.5)))


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart()]
