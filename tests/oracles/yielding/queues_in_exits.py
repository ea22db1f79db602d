"""Situations with queues in the exit that the ego and a vehicle with the right of way share.

The first family are egos that are the last of a queue: they take a place in it, not the right of
way. The second are egos that take the right of way although there is a vehicle or a queue ahead.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.responsibility.ways import Drive, cut
from tests.oracles.yielding.paths import along, before, coming, going, pace, way
from tests.oracles.yielding.situation import Driven, Situation, situation

TEE, ART, GRID, RING = "tee-town", "arterial", "signal-grid", "roundabout"

INTO_MILL = ("harbour_0_0", "mill_1_0")
HARBOUR_WEST = ("-harbour_1_0", "-harbour_0_0")
HARBOUR_IN = ("-harbour_1_0", "mill_1_0")
OUT_RIGHT = ("-mill_1_0", "-harbour_0_0")
INTO_GARDEN = ("south_3_1", "garden_1_1")
SECOND_IN = ("-corner_southeast_1", "garden_1_1")
INTO_FARM = ("wb_school_pocket_2", "farm_s_0")
FARM_IN = ("eb_hill_0", "farm_s_0")
ROSE = ("-rose_s_0", "eb_rose_0", "eb_rose_pocket_0")
STATION = ("eb_mill_pocket_0", "eb_station_0", "eb_rose_0", "eb_rose_pocket_0")
_HALF = ("small_ring_2_0", "small_ring_3_0", "small_ring_4_0", "small_ring_5_0", "small_ring_6_0")
ENTRY = ("link_3_0", "small_west_entry_0", "small_ring_6_0", "small_south_exit_0", "-south_4_0")
ROUND = ("-quarry_0", "small_east_entry_0", *_HALF, "small_south_exit_0", "-south_4_0")

WAITS = pace(0.0, (17.0, 2.0, 7.0))
"""A queue that stands, and moves on at last."""


def _in_exit(
    network: str, ids: tuple[str, ...], metres: float, time: float, *speeds: tuple[float, float]
) -> Drive:
    """Along lanes, so that its centre is at a time so many metres beyond the exit's begin.

    The exit is the second lane, in a ring the third.
    """
    line = way(network, *ids)
    x, y = way(network, ids[2 if network == RING else 1])[0]
    return before(line, (float(x), float(y)), -metres, time, *speeds)


def _ahead(
    network: str,
    lane: str,
    metres: float,
    *speeds: tuple[float, float],
    name: str = "leader",
) -> Car:
    """A vehicle whose centre is at the start so many metres beyond a lane's begin."""
    return Car(drive=Drive(way=cut(way(network, lane), metres), speeds=speeds), name=name)


def _last_of_the_queue() -> list[Situation]:
    return [
        situation(
            "left-turn-last-of-a-standing-queue-and-oncoming-turns-right",
            "The ego turns left and stops behind a standing queue, a length out of the junction; "
            "an oncoming car that turns right into the road stops before the junction.",
            TEE,
            _in_exit(TEE, INTO_MILL, 8.0, 9.0, *pace(5.0, (7.0, 3.0, 0.0), (18.5, 2.0, 6.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_IN,
                    INTO_MILL,
                    32.0,
                    8.8,
                    *pace(11.0, (8.8, 4.4, 0.0), (20.0, 2.0, 6.0)),
                )
            ),
            _ahead(TEE, "mill_1_0", 15.5, *WAITS),
            _ahead(TEE, "mill_1_0", 23.0, *WAITS, name="first"),
            seconds=28.0,
        ),
        situation(
            "left-turn-last-of-a-standing-queue-far-out-and-oncoming-turns-right",
            "The ego turns left and stops behind a standing queue, three lengths out of the "
            "junction; an oncoming car turns right into the road and stops behind it.",
            GRID,
            _in_exit(GRID, INTO_GARDEN, 19.0, 10.0, *pace(6.0, (7.6, 3.0, 0.0), (18.5, 2.0, 6.0))),
            Car(
                drive=coming(
                    GRID,
                    SECOND_IN,
                    INTO_GARDEN,
                    18.0,
                    8.6,
                    *pace(9.0, (8.6, 4.3, 3.0), (11.5, 3.0, 0.0), (20.0, 2.0, 6.0)),
                )
            ),
            _ahead(GRID, "garden_1_1", 26.5, *WAITS),
            _ahead(GRID, "garden_1_1", 34.0, *WAITS, name="first"),
            seconds=28.0,
        ),
        situation(
            "left-turn-last-of-a-creeping-queue-and-oncoming-turns-right",
            "The ego turns left and creeps behind a queue that creeps; an oncoming car that turns "
            "right into the road brakes to the speed of the queue and follows.",
            ART,
            _in_exit(ART, INTO_FARM, 9.0, 9.0, *pace(6.0, (7.4, 3.0, 2.0), (16.0, 1.5, 6.0))),
            Car(
                drive=coming(
                    ART,
                    FARM_IN,
                    INTO_FARM,
                    31.0,
                    8.6,
                    *pace(11.0, (8.6, 4.4, 2.5), (16.5, 1.5, 6.0)),
                )
            ),
            _ahead(ART, "farm_s_0", 2.0, *pace(2.0, (15.0, 1.5, 7.0))),
            _ahead(ART, "farm_s_0", 11.0, *pace(2.0, (14.5, 1.5, 7.0)), name="first"),
            seconds=24.0,
        ),
        situation(
            "out-right-last-of-a-creeping-queue-and-car-comes-straight-on",
            "The ego turns right on to the main road behind a queue that creeps there; a car on "
            "the main road comes up to the queue and brakes.",
            TEE,
            _in_exit(TEE, OUT_RIGHT, 8.0, 9.0, *pace(4.5, (7.4, 2.5, 1.5), (17.0, 1.5, 8.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_WEST,
                    OUT_RIGHT,
                    34.0,
                    8.8,
                    *pace(12.0, (8.8, 4.3, 1.5), (17.5, 1.5, 8.0)),
                )
            ),
            _ahead(TEE, "-harbour_0_0", 3.0, *pace(1.5, (16.0, 1.5, 9.0))),
            _ahead(TEE, "-harbour_0_0", 12.0, *pace(1.5, (15.5, 1.5, 9.0)), name="first"),
            seconds=24.0,
        ),
        situation(
            "enters-ring-last-of-a-standing-queue-and-circulating-car-stops",
            "The ego enters the small roundabout and stops behind a queue that stands back from "
            "the next exit; a circulating car stops before the entry.",
            RING,
            _in_exit(RING, ENTRY, 5.5, 9.0, *pace(5.0, (6.9, 3.0, 0.0), (18.0, 1.5, 5.0))),
            Car(
                drive=coming(
                    RING,
                    ROUND,
                    ENTRY,
                    20.0,
                    8.7,
                    *pace(7.5, (8.7, 4.3, 0.0), (19.5, 1.5, 5.0)),
                )
            ),
            Car(
                drive=_in_exit(RING, ENTRY, 13.0, 1.0, *pace(0.0, (16.5, 1.5, 6.0))),
                name="leader",
            ),
            seconds=26.0,
        ),
        situation(
            "left-turn-last-of-a-standing-queue-and-sumo-turns-right",
            "The ego turns left and stops behind a standing queue; an oncoming car that SUMO "
            "drives turns right into the road and brakes.",
            TEE,
            _in_exit(TEE, INTO_MILL, 12.0, 9.5, *pace(5.0, (7.5, 3.0, 0.0), (19.0, 2.0, 6.0))),
            Driven(route=along(TEE, HARBOUR_IN, 12.0), speed=11.0, start_time=0.6),
            _ahead(TEE, "mill_1_0", 19.5, *WAITS),
            _ahead(TEE, "mill_1_0", 27.0, *WAITS, name="first"),
            seconds=30.0,
        ),
    ]


def _closes_up_to_the_queue() -> list[Situation]:
    """As on the routes of the CARLA Leaderboard: the ego is out of the junction just in time."""
    x, y = way(RING, "small_ring_6_0")[0].tolist()
    return [
        situation(
            "left-turn-closes-up-to-a-queue-and-oncoming-turns-right-and-follows",
            "The ego turns left and closes up to a queue that moves on; an oncoming car that turns "
            "right into the road brakes from 10.6 to 3.8 m/s and follows.",
            TEE,
            _in_exit(TEE, INTO_MILL, 3.0, 9.0, *pace(3.5, (8.3, 1.0, 2.0), (11.0, 1.0, 6.0))),
            Car(
                drive=_in_exit(
                    TEE, HARBOUR_IN, -23.0, 8.3, *pace(10.6, (8.3, 4.4, 3.8), (10.3, 1.5, 5.5))
                )
            ),
            _ahead(TEE, "mill_1_0", 11.5, *pace(0.0, (9.0, 1.2, 7.0))),
            _ahead(TEE, "mill_1_0", 18.5, *pace(0.0, (8.0, 1.2, 7.0)), name="first"),
            seconds=18.0,
        ),
        situation(
            "left-turn-closes-up-to-a-queue-and-oncoming-stops-at-its-line",
            "The ego turns left and comes to a stop behind a standing queue; an oncoming car that "
            "turns right into the road brakes from 12.9 m/s to a stop at its line.",
            TEE,
            _in_exit(TEE, INTO_MILL, 6.0, 8.5, *pace(4.5, (6.5, 2.5, 0.0), (18.5, 2.0, 6.0))),
            Car(
                drive=_in_exit(
                    TEE, HARBOUR_IN, -34.0, 7.0, *pace(12.9, (7.0, 4.4, 0.0), (20.0, 2.0, 6.0))
                )
            ),
            _ahead(TEE, "mill_1_0", 13.3, *WAITS),
            _ahead(TEE, "mill_1_0", 20.8, *WAITS, name="first"),
            seconds=28.0,
        ),
        situation(
            "left-turn-closes-up-to-a-queue-and-oncoming-turns-right-early-slow",
            "The ego turns left and comes to a stop behind a standing queue; an oncoming car "
            "brakes to 4 m/s well before its right turn, and rolls up to the queue.",
            GRID,
            _in_exit(GRID, INTO_GARDEN, 6.0, 9.5, *pace(4.5, (7.7, 2.5, 0.0), (18.5, 2.0, 6.0))),
            Car(
                drive=_in_exit(
                    GRID,
                    SECOND_IN,
                    -27.0,
                    8.3,
                    *pace(11.0, (8.3, 4.4, 4.0), (11.0, 0.95, 0.0), (20.0, 2.0, 6.0)),
                )
            ),
            _ahead(GRID, "garden_1_1", 13.3, *WAITS),
            _ahead(GRID, "garden_1_1", 20.8, *WAITS, name="first"),
            seconds=28.0,
        ),
        situation(
            "out-right-closes-up-to-a-creeping-queue-and-car-comes-straight-on",
            "The ego turns right on to the main road and creeps behind a queue there; a car on the "
            "main road, 26 m behind it, brakes by 4.4 m/s² to the speed of the queue.",
            TEE,
            _in_exit(TEE, OUT_RIGHT, 5.0, 8.8, *pace(4.5, (7.4, 2.5, 1.5), (17.0, 1.5, 8.0))),
            Car(
                drive=_in_exit(
                    TEE, HARBOUR_WEST, -21.0, 8.6, *pace(11.5, (8.6, 4.4, 1.5), (17.5, 1.5, 8.0))
                )
            ),
            _ahead(TEE, "-harbour_0_0", 0.3, *pace(1.5, (16.0, 1.5, 9.0))),
            _ahead(TEE, "-harbour_0_0", 8.5, *pace(1.5, (15.5, 1.5, 9.0)), name="first"),
            seconds=24.0,
        ),
        situation(
            "enters-ring-and-closes-up-to-a-queue-and-circulating-car-stops",
            "The ego enters the small roundabout and comes to a stop behind a queue that stands "
            "back from the next exit; a circulating car 19 m behind it brakes to a stop.",
            RING,
            _in_exit(RING, ENTRY, 4.0, 9.5, *pace(4.5, (7.5, 2.5, 0.0), (18.0, 1.5, 5.0))),
            Car(
                drive=before(
                    way(RING, *ROUND),
                    (x, y),
                    16.0,
                    8.3,
                    *pace(7.5, (8.3, 4.4, 0.0), (19.5, 1.5, 5.0)),
                )
            ),
            Car(
                drive=_in_exit(RING, ENTRY, 11.3, 1.0, *pace(0.0, (16.5, 1.5, 6.0))), name="leader"
            ),
            seconds=26.0,
        ),
    ]


def _takes_the_right_of_way() -> list[Situation]:
    return [
        situation(
            "left-turn-into-a-free-exit-close-before-oncoming-that-turns-right",
            "The ego turns left slowly; an oncoming car that turns right into the road brakes "
            "nearly to a stop. The next car in the exit is 45 m away and drives on.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_IN, 8.0, *pace(3.5, (9.5, 1.0, 6.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_IN,
                    INTO_MILL,
                    15.0,
                    7.4,
                    *pace(8.0, (7.4, 4.6, 0.8), (10.0, 1.2, 5.0)),
                )
            ),
            _ahead(TEE, "mill_1_0", 5.0, *pace(0.5, (0.3, 1.0, 7.0))),
        ),
        situation(
            "out-right-behind-a-flowing-leader-close-before-car",
            "A car passes on the main road at 13 m/s; the ego turns right behind it at 5 m/s, "
            "ahead of a second car, which brakes by 5.5 m/s².",
            ART,
            going(ART, ROSE, STATION, 7.0, *pace(5.0, (7.0, 1.5, 12.0))),
            Car(drive=coming(ART, STATION, ROSE, -17.0, 7.0, (0.0, 13.0)), name="leader"),
            Car(
                drive=coming(
                    ART, STATION, ROSE, 30.0, 6.6, *pace(14.0, (6.6, 5.5, 6.0), (9.0, 1.2, 11.0))
                )
            ),
        ),
        situation(
            "left-turn-close-before-oncoming-and-queue-far-in-the-exit",
            "The ego turns left slowly close before an oncoming car that turns right, which brakes "
            "nearly to a stop; a queue stands 38 m behind the junction.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_IN, 8.0, *pace(3.5, (13.0, 1.5, 0.0), (20.0, 1.5, 5.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_IN,
                    INTO_MILL,
                    14.0,
                    7.5,
                    *pace(8.0, (7.5, 4.8, 1.0), (9.8, 1.0, 3.5), (13.5, 1.5, 0.0)),
                )
            ),
            _ahead(TEE, "mill_1_0", 38.0, *WAITS),
            _ahead(TEE, "mill_1_0", 45.5, *WAITS, name="first"),
            seconds=18.0,
        ),
        situation(
            "left-turn-stands-in-the-junction-behind-a-queue-and-oncoming-stops",
            "The ego turns left although its exit is full, and stands across the oncoming lane; "
            "an oncoming car that goes straight on brakes by 4.5 m/s² to a stop.",
            TEE,
            _in_exit(TEE, INTO_MILL, -3.0, 9.0, *pace(5.0, (7.0, 3.0, 0.0), (17.5, 2.0, 6.0))),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_WEST,
                    INTO_MILL,
                    30.0,
                    8.2,
                    *pace(12.0, (8.2, 4.5, 0.0), (21.0, 2.0, 8.0)),
                )
            ),
            _ahead(TEE, "mill_1_0", 4.0, *WAITS),
            _ahead(TEE, "mill_1_0", 11.5, *WAITS, name="first"),
            seconds=28.0,
        ),
        situation(
            "out-right-into-the-last-place-of-a-queue-right-before-car",
            "The ego turns right into the last place behind a standing queue, 8 m before a car on "
            "the main road, which brakes by 6 m/s² to a stop right behind it.",
            TEE,
            _in_exit(TEE, OUT_RIGHT, 8.5, 9.0, *pace(5.0, (7.0, 3.0, 0.0), (18.5, 2.0, 6.0))),
            Car(
                drive=_in_exit(
                    TEE, HARBOUR_WEST, 2.7, 9.2, *pace(11.0, (7.2, 6.0, 0.0), (20.0, 2.0, 6.0))
                )
            ),
            _ahead(TEE, "-harbour_0_0", 16.0, *WAITS),
            _ahead(TEE, "-harbour_0_0", 23.5, *WAITS, name="first"),
            seconds=26.0,
        ),
        situation(
            "enters-ring-close-before-circulating-car-and-queue-far-on",
            "The ego enters the small roundabout close before a circulating car, which brakes by "
            "5 m/s²; a queue stands in the exit, 40 m on.",
            RING,
            going(RING, ENTRY, ROUND, 8.0, *pace(5.0, (11.5, 1.5, 0.0), (17.0, 1.5, 5.0))),
            Car(
                drive=coming(
                    RING,
                    ROUND,
                    ENTRY,
                    13.0,
                    7.6,
                    *pace(7.0, (7.6, 5.0, 2.0), (9.5, 1.0, 3.5), (12.5, 1.5, 0.0)),
                )
            ),
            _ahead(RING, "small_south_exit_0", 30.0, *WAITS),
            seconds=18.0,
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_last_of_the_queue(), *_closes_up_to_the_queue(), *_takes_the_right_of_way()]
