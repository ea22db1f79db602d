"""Situations at the entries of the two roundabouts of ``roundabout``."""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.yielding.paths import coming, going, pace
from tests.oracles.yielding.situation import Situation, situation, standing

TOWN = "roundabout"

ENTRY = ("link_3_0", "small_west_entry_0", "small_ring_6_0", "small_ring_7_0", "small_ring_8_0")
THROUGH = (*ENTRY, "small_east_exit_0", "quarry_0")
SOUTHWARDS = (*ENTRY[:3], "small_south_exit_0", "-south_4_0")
_HALF = ("small_ring_2_0", "small_ring_3_0", "small_ring_4_0", "small_ring_5_0", "small_ring_6_0")
FROM_EAST = ("-quarry_0", "small_east_entry_0", *_HALF)
ROUND = (*FROM_EAST, "small_ring_7_0", "small_ring_8_0", "small_ring_1_0", "small_ring_2_0")
LEAVING = (*FROM_EAST[:5], "small_west_exit_0", "-link_3_0")
FROM_NORTH = ("north_3_0", "small_north_entry_0", *_HALF[2:], "small_south_exit_0", "-south_4_0")
FROM_SOUTH = ("south_4_0", "small_south_entry_0", "small_ring_8_0", "small_east_exit_0", "quarry_0")
NEXT = ("small_ring_7_0", "small_ring_8_0")

OUTER_IN = (
    "-west_1_0",
    "great_west_entry_0",
    "great_ring_6_0",
    "great_south_exit_0",
    "southgate_0",
)
INNER_IN = (
    *("-west_1_1", "great_west_entry_1", "great_ring_6_1", "great_ring_7_1", "great_ring_8_1"),
    *("great_east_exit_1", "link_1_1"),
)
INNER = (
    *("-link_1_1", "great_east_entry_1", "great_ring_2_1", "great_ring_3_1", "great_ring_4_1"),
    *("great_ring_5_1", "great_ring_6_1", "great_ring_7_1", "great_ring_8_1", "great_east_exit_1"),
)


def _close() -> list[Situation]:
    return [
        situation(
            "enters-ring-and-circulating-car-brakes-hard",
            "The ego enters the small roundabout; a circulating car brakes by 5 m/s².",
            TOWN,
            going(TOWN, THROUGH, ROUND, 8.0, (0.0, 5.5)),
            Car(
                drive=coming(
                    TOWN, ROUND, THROUGH, 13.0, 7.6, *pace(6.9, (7.6, 5.0, 2.0), (10.0, 1.0, 5.0))
                )
            ),
        ),
        situation(
            "enters-ring-and-circulating-car-touches-it",
            "The ego enters the small roundabout; a circulating car runs into its side.",
            TOWN,
            going(TOWN, THROUGH, ROUND, 8.0, (0.0, 4.5)),
            Car(drive=coming(TOWN, ROUND, THROUGH, 4.5, 8.0, (0.0, 6.5))),
        ),
        situation(
            "enters-ring-and-circulating-car-follows-closely",
            "The ego enters the small roundabout faster than a circulating car, which follows "
            "closely without braking.",
            TOWN,
            going(TOWN, SOUTHWARDS, ROUND, 8.0, (0.0, 6.5)),
            Car(drive=coming(TOWN, ROUND, SOUTHWARDS, 7.8, 8.0, (0.0, 5.5))),
        ),
        situation(
            "enters-inner-lane-and-inner-car-brakes",
            "The ego enters the inner lane of the large roundabout; a car there brakes by 4 m/s².",
            TOWN,
            going(TOWN, INNER_IN, INNER, 8.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    TOWN, INNER, INNER_IN, 17.0, 7.4, *pace(9.5, (7.4, 4.0, 4.5), (10.0, 1.0, 6.5))
                )
            ),
        ),
        situation(
            "stands-across-the-ring-behind-a-queue",
            "The ego enters the small roundabout and stops behind a standing car; a circulating "
            "car stops before its tail.",
            TOWN,
            going(TOWN, SOUTHWARDS, ROUND, 7.0, *pace(5.0, (7.2, 3.5, 0.0))),
            Car(drive=coming(TOWN, ROUND, SOUTHWARDS, 19.0, 7.5, *pace(6.5, (7.8, 3.8, 0.0)))),
            standing(TOWN, SOUTHWARDS, ROUND, -12.5, name="leader"),
        ),
        situation(
            "two-circulating-cars-and-ego-enters-between",
            "One circulating car passes before the ego enters; the next one brakes by 4.5 m/s².",
            TOWN,
            going(TOWN, THROUGH, ROUND, 8.6, (0.0, 5.5)),
            Car(drive=coming(TOWN, ROUND, THROUGH, 0.0, 6.6, (0.0, 6.9)), name="first"),
            Car(
                drive=coming(
                    TOWN, ROUND, THROUGH, 13.0, 8.2, *pace(6.9, (8.2, 4.5, 2.0), (10.8, 1.0, 5.0))
                ),
                name="second",
            ),
        ),
    ]


def _apart() -> list[Situation]:
    return [
        situation(
            "enters-ring-while-circulating-car-leaves-it",
            "A circulating car brakes and leaves the roundabout one exit before the ego's entry.",
            TOWN,
            going(TOWN, THROUGH, ROUND, 8.0, (0.0, 5.5)),
            Car(drive=going(TOWN, LEAVING, LEAVING[5:], 7.8, *pace(6.9, (6.6, 4.0, 4.0)))),
        ),
        situation(
            "enters-ring-well-before-slow-car",
            "The ego enters the small roundabout; a slow circulating car arrives three seconds "
            "behind it.",
            TOWN,
            going(TOWN, SOUTHWARDS, ROUND, 8.0, (0.0, 6.5)),
            Car(drive=coming(TOWN, ROUND, SOUTHWARDS, 19.5, 8.0, (0.0, 4.5))),
        ),
        situation(
            "enters-outer-lane-beside-inner-car",
            "The ego enters the outer lane of the large roundabout; a car in the inner lane "
            "brakes by 3.6 m/s² beside it.",
            TOWN,
            going(TOWN, OUTER_IN, ("great_ring_6_0",), 8.0, (0.0, 7.0)),
            Car(
                drive=going(
                    TOWN,
                    INNER,
                    ("great_ring_6_1",),
                    8.6,
                    *pace(9.5, (7.0, 3.6, 6.0), (9.0, 1.0, 8.0)),
                )
            ),
        ),
        situation(
            "circulates-while-entering-car-brakes-hard",
            "The ego circulates; a car at the next entry brakes by 5 m/s² and waits.",
            TOWN,
            going(TOWN, FROM_NORTH, THROUGH, 8.0, (0.0, 6.0)),
            Car(
                drive=coming(
                    TOWN,
                    THROUGH,
                    FROM_NORTH,
                    10.0,
                    7.0,
                    *pace(8.5, (6.0, 5.0, 0.5), (9.6, 1.5, 5.0)),
                )
            ),
        ),
        situation(
            "enters-ring-while-circulating-car-stands-in-it",
            "A car has stopped in the ring 14 m before the ego's entry, which the ego uses.",
            TOWN,
            going(TOWN, SOUTHWARDS, ROUND, 9.0, (0.0, 5.5)),
            Car(
                drive=coming(
                    TOWN,
                    ROUND,
                    SOUTHWARDS,
                    14.0,
                    5.5,
                    *pace(6.0, (3.5, 3.0, 0.0), (13.0, 1.5, 5.0)),
                )
            ),
            seconds=18.0,
        ),
        situation(
            "waits-at-the-entry-for-circulating-car",
            "The ego stops at the entry, lets a circulating car pass, and enters behind it.",
            TOWN,
            going(TOWN, THROUGH, ROUND, 10.6, *pace(6.0, (4.5, 3.0, 0.0), (8.0, 2.0, 5.0))),
            Car(drive=coming(TOWN, ROUND, THROUGH, 0.0, 7.0, (0.0, 6.5))),
            seconds=18.0,
        ),
    ]


def _counted_twice() -> list[Situation]:
    return [
        situation(
            "same-car-brakes-at-two-parts-of-the-ring",
            "The ego enters before a circulating car, which brakes, and brakes again behind the "
            "slowing ego at the next entry.",
            TOWN,
            going(TOWN, THROUGH, ROUND, 8.0, *pace(5.5, (9.5, 2.5, 2.5), (12.0, 1.5, 6.0))),
            Car(
                drive=coming(
                    TOWN,
                    ROUND,
                    THROUGH,
                    14.0,
                    7.4,
                    *pace(
                        6.9, (7.4, 4.5, 3.0), (8.8, 1.5, 4.5), (10.3, 4.0, 1.5), (12.5, 1.0, 5.0)
                    ),
                )
            ),
        ),
        situation(
            "passes-two-entries-before-two-cars",
            "The ego enters before a circulating car that brakes; at the next entry a car that "
            "is about to enter brakes.",
            TOWN,
            going(TOWN, THROUGH, ROUND, 7.5, (0.0, 5.5)),
            Car(
                drive=coming(
                    TOWN, ROUND, THROUGH, 13.5, 7.0, *pace(6.9, (7.0, 5.0, 2.0), (10.0, 1.0, 5.0))
                )
            ),
            Car(
                drive=coming(
                    TOWN, FROM_SOUTH, NEXT, 7.0, 10.0, *pace(8.0, (8.2, 4.5, 0.0), (15.0, 1.5, 5.0))
                ),
                name="entering",
            ),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_close(), *_apart(), *_counted_twice()]
