"""Situations with egos that stand in a junction, and others that turn into the ego's road.

Of the kinds that were found among background traffic on the routes of the CARLA Leaderboard.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import Car
from tests.oracles.yielding.paths import along, coming, going, pace
from tests.oracles.yielding.situation import Driven, Situation, situation

TEE = "tee-town"

INTO_MILL = ("harbour_0_0", "mill_1_0")
HARBOUR_WEST = ("-harbour_1_0", "-harbour_0_0")
HARBOUR_IN = ("-harbour_1_0", "mill_1_0")


def situations() -> list[Situation]:
    """All of this kind."""
    return [
        situation(
            "left-turn-waits-with-a-corner-in-the-oncoming-lane",
            "The ego waits to turn left with a front corner in the way of an oncoming car, which "
            "stops; then the ego goes.",
            TEE,
            going(
                TEE, INTO_MILL, HARBOUR_WEST, 13.7, *pace(5.0, (4.6, 2.5, 0.0), (11.4, 2.0, 5.0))
            ),
            Car(
                drive=coming(
                    TEE,
                    HARBOUR_WEST,
                    INTO_MILL,
                    26.0,
                    7.0,
                    *pace(11.0, (7.0, 4.4, 0.0), (14.5, 2.0, 8.0)),
                )
            ),
            seconds=22.0,
        ),
        situation(
            "left-turn-stands-in-the-exit-for-a-quarter-of-a-minute",
            "The ego turns left and stands with its tail at the junction; twelve seconds later an "
            "oncoming car that turns right into the road brakes hard, and waits behind it.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_WEST, 5.0, *pace(5.0, (6.6, 3.0, 0.0), (25.0, 2.0, 6.0))),
            Driven(route=along(TEE, HARBOUR_IN, 10.0), speed=10.0, start_time=13.0),
            seconds=32.0,
        ),
        situation(
            "left-turn-and-oncoming-slows-early-for-its-right-turn",
            "The ego turns left; an oncoming car that turns right into the same road slows down "
            "for its turn some metres earlier than it must, and follows.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR_IN, 7.0, *pace(5.0, (7.0, 1.5, 8.0))),
            Car(drive=coming(TEE, HARBOUR_IN, INTO_MILL, 24.0, 7.0, *pace(10.7, (7.0, 4.4, 6.8)))),
        ),
    ]
