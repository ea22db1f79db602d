"""Situations among SUMO's background traffic, whose vehicles react to the ego."""

from __future__ import annotations

from tests.oracles.yielding.paths import going, pace
from tests.oracles.yielding.situation import Situation, situation

TEE, ART, RING, OLD = "tee-town", "arterial", "roundabout", "old-town"

OUT_LEFT = ("-mill_1_0", "harbour_1_0")
HARBOUR = ("-harbour_1_0", "-harbour_0_0")
CHURCH_LEFT = ("-church_1_0", "high_3_0")
HIGH_WEST = ("-high_3_0", "-high_2_0")
ROSE = ("-rose_s_0", "eb_rose_0", "eb_rose_pocket_0")
STATION = ("eb_station_0", "eb_rose_0")
INTO_FARM = ("wb_school_pocket_2", "farm_s_0")
FARM_EAST = ("eb_hill_0", "eb_farm_0")
ENTRY = ("link_3_0", "small_west_entry_0", "small_ring_6_0", "small_south_exit_0", "-south_4_0")
CIRCLE = ("small_ring_5_0", "small_ring_6_0")
GATE = ("west_street_1", "wall_5_1", "wall_6_1")
WALL = ("wall_4_1", "wall_5_1")

TURNING_OUT = pace(5.0, (9.0, 1.5, 12.0))


def situations() -> list[Situation]:
    """All of this kind."""
    return [
        situation(
            "background-at-the-harbour-first",
            "The ego turns left among 40 vehicles; 56 m away one brakes for its own right turn.",
            TEE,
            going(TEE, OUT_LEFT, HARBOUR, 9.0, (0.0, 5.0)),
            background=40,
            seed=1,
            seconds=17.0,
        ),
        situation(
            "background-at-the-harbour-second",
            "The ego turns left among 40 vehicles; one with priority brakes by 9 m/s² close to it.",
            TEE,
            going(TEE, OUT_LEFT, HARBOUR, 9.0, (0.0, 5.0)),
            background=40,
            seed=7,
            seconds=17.0,
        ),
        situation(
            "background-at-the-church",
            "The ego turns left out of Church Road among 40 vehicles; one brakes hard close to it.",
            TEE,
            going(TEE, CHURCH_LEFT, HIGH_WEST, 9.0, (0.0, 5.0)),
            background=40,
            seed=8,
            seconds=17.0,
        ),
        situation(
            "background-at-rose-street-first",
            "The ego turns right on to the arterial road among 110 vehicles; those behind that "
            "brake are 60 m and more away.",
            ART,
            going(ART, ROSE, STATION, 9.0, *TURNING_OUT),
            background=110,
            seed=1,
            seconds=17.0,
        ),
        situation(
            "background-at-rose-street-second",
            "The ego turns right on to the arterial road among 110 vehicles; one in its lane "
            "brakes 21 m behind it, others turn off.",
            ART,
            going(ART, ROSE, STATION, 9.0, *TURNING_OUT),
            background=110,
            seed=3,
            seconds=17.0,
        ),
        situation(
            "background-at-the-farm",
            "The ego turns left off the arterial road among 110 vehicles; one that turns right "
            "into the same road brakes hard, and another behind it by 4.5 m/s².",
            ART,
            going(ART, INTO_FARM, FARM_EAST, 9.0, (0.0, 5.5)),
            background=110,
            seed=3,
            seconds=17.0,
        ),
        situation(
            "background-at-the-roundabout",
            "The ego enters the small roundabout among 60 vehicles; some at the other entries and "
            "exits brake.",
            RING,
            going(RING, ENTRY, CIRCLE, 9.0, (0.0, 5.5)),
            background=60,
            seed=1,
            seconds=17.0,
        ),
        situation(
            "background-at-the-town-wall",
            "The ego turns left at the town wall among 40 vehicles; two on the main road brake, "
            "one of them to turn off.",
            OLD,
            going(OLD, GATE, WALL, 9.0, (0.0, 5.0)),
            background=40,
            seed=1,
            seconds=17.0,
        ),
    ]
