"""Situations with vehicles that SUMO's own model drives, near and far.

They brake by up to 4.5 m/s² for lower limits, turns, signs, signals and vehicles ahead, and harder
for what is suddenly in their way.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import Car
from tests.oracles.yielding.paths import along, before, coming, going, pace, way
from tests.oracles.yielding.situation import Driven, Situation, situation, standing

TEE, ART, RURAL, HIGH, OLD = "tee-town", "arterial", "rural", "highway", "old-town"
GRID, RING = "signal-grid", "roundabout"

RIDGE_LEFT = ("-ridge_1_0", "valley_7_0", "valley_8_0")
VALLEY = ("-valley_8_0", "-valley_7_0", "-valley_6_0")
MILL_RIGHT = ("mill_0", "-valley_26_0", "-valley_25_0")
MILL_LEFT = ("mill_0", "valley_27_0", "valley_28_0")
MILL_MAIN = ("valley_25_0", "valley_26_0", "valley_27_0")
TRACK_LEFT = ("-quarry_track_0", "-valley_11_0", "-valley_10_0")
QUARRY_MAIN = ("valley_9_0", "valley_10_0", "valley_11_0", "valley_12_0")
OUT_LEFT = ("-mill_1_0", "harbour_1_0")
OUT_RIGHT = ("-mill_1_0", "-harbour_0_0")
HARBOUR = ("-harbour_1_0", "-harbour_0_0")
HARBOUR_IN = ("-harbour_1_0", "mill_1_0")
FERRY_LEFT = ("-ferry_1_0", "harbour_2_0")
FERRY_MAIN = ("-harbour_2_0", "-harbour_1_0")
ROSE = ("-rose_s_0", "eb_rose_0", "eb_rose_pocket_0")
ROSE_MAIN = ("eb_station_0", "eb_rose_0", "eb_rose_pocket_0", "eb_hill_0")
ROSE_IN = ("eb_station_0", "rose_s_0")
RAMP_RIGHT = ("eb_a_exit_ramp_0", "west_round_0")
TERMINAL = ("-south_1_0", "west_round_0")
TERMINAL_IN = ("-south_1_0", "eb_a_entry_ramp_0")
HILL_LEFT = ("wb_farm_pocket_2", "hill_s_0")
HILL_EAST = ("eb_rose_0", "eb_rose_pocket_0", "eb_hill_0")
INTO_CHAPEL = ("-south_3_0", "chapel_0")
VILLAGE_EAST = ("south_2_0", "south_3_0")
CHAPEL_IN = ("south_2_0", "chapel_0")
CHAPEL_RIGHT = ("-chapel_0", "south_3_0")
CLOISTER = ("cloister_1", "castle_street_1")
CASTLE_HILL = ("castle_hill_1", "castle_street_1")
CASTLE_LEFT = ("-castle_1_1", "south_2_1")
SOUTH_WEST = ("-south_2_1", "-corner_southwest_1")
INTO_MILL = ("harbour_0_0", "mill_1_0")
_HALF = ("small_ring_2_0", "small_ring_3_0", "small_ring_4_0", "small_ring_5_0", "small_ring_6_0")
ENTRY = ("link_3_0", "small_west_entry_0", "small_ring_6_0", "small_south_exit_0", "-south_4_0")
FROM_EAST = ("-quarry_0", "small_east_entry_0", *_HALF, "small_south_exit_0", "-south_4_0")
PROTECTED: Mapping[str, Any] = {"junctions": {"hill": {"offset": -30.0}}}
"""Yellow for the arterial road until 2 s, green for left turns from 2 to 8 s."""


def _far() -> list[Situation]:
    return [
        situation(
            "sumo-at-the-ridge-and-ego-turns-left",
            "The ego turns left on to the valley road; far off a car brakes for a lower limit.",
            RURAL,
            going(RURAL, RIDGE_LEFT, VALLEY, 8.0, (0.0, 6.0)),
            Driven(route=along(RURAL, VALLEY, 165.0), speed=22.0),
        ),
        situation(
            "sumo-at-the-mill-and-ego-turns-left",
            "The ego turns left from the mill road; far off a car brakes for a lower limit.",
            RURAL,
            going(RURAL, MILL_LEFT, MILL_MAIN, 8.0, *pace(6.0, (8.0, 1.5, 11.0))),
            Driven(route=along(RURAL, MILL_MAIN, 665.0), speed=21.0),
        ),
        situation(
            "sumo-at-the-quarry-and-ego-turns-left",
            "The ego turns left from the quarry track; far off a car brakes for a lower limit.",
            RURAL,
            going(RURAL, TRACK_LEFT, QUARRY_MAIN, 8.0, (0.0, 6.5)),
            Driven(route=along(RURAL, QUARRY_MAIN, 128.0), speed=20.0),
        ),
        situation(
            "sumo-turns-on-to-the-ramp-and-ego-turns-right",
            "The ego turns right from a ramp; a car brakes to turn right before it, on to another.",
            HIGH,
            going(HIGH, RAMP_RIGHT, TERMINAL, 7.0, *pace(5.0, (7.0, 1.5, 12.0))),
            Driven(route=along(HIGH, TERMINAL_IN, 195.0), speed=19.0),
        ),
        situation(
            "sumo-turns-into-the-road-that-ego-leaves",
            "The ego turns right out of a road, into which a car brakes to turn right.",
            TEE,
            going(TEE, OUT_RIGHT, HARBOUR, 7.0, *pace(5.0, (7.5, 1.5, 9.0))),
            Driven(route=along(TEE, HARBOUR_IN, 35.0), speed=12.0),
        ),
        situation(
            "two-sumo-cars-and-ego-turns-right",
            "The ego turns right on to the road; 50 m back one car brakes to turn off, and the one "
            "behind it brakes too.",
            ART,
            going(ART, ROSE, ROSE_MAIN, 6.0, *pace(6.0, (6.0, 2.5, 15.0))),
            Driven(route=along(ART, ROSE_IN, 20.0), speed=15.0, name="leader"),
            Driven(route=along(ART, ROSE_MAIN, 5.0), speed=16.0),
        ),
        situation(
            "sumo-and-standing-car-and-ego-turns-left",
            "The ego turns left; a car that comes from the right brakes for a standing one, 60 m "
            "before the junction.",
            TEE,
            going(TEE, FERRY_LEFT, FERRY_MAIN, 8.0, (0.0, 6.0)),
            Driven(route=along(TEE, FERRY_MAIN, 55.0), speed=11.0),
            standing(TEE, FERRY_MAIN, FERRY_LEFT, 58.0, name="leader"),
        ),
        situation(
            "sumo-behind-braking-car-and-ego-turns-right",
            "The ego turns right; 60 to 90 m back two cars brake one behind the other.",
            HIGH,
            going(HIGH, CHAPEL_RIGHT, VILLAGE_EAST, 7.0, *pace(6.0, (7.0, 2.0, 13.0))),
            Driven(route=along(HIGH, VILLAGE_EAST, 21.0), speed=13.0),
            Car(
                drive=coming(
                    HIGH, VILLAGE_EAST, CHAPEL_RIGHT, 58.0, 7.0, *pace(13.0, (6.0, 4.5, 3.0))
                ),
                name="leader",
            ),
        ),
        situation(
            "sumo-oncoming-at-signals-and-ego-turns-left",
            "The ego turns left on a green of its own; an oncoming car brakes for its red.",
            ART,
            going(ART, HILL_LEFT, HILL_EAST, 6.5, (0.0, 6.0)),
            Driven(route=along(ART, HILL_EAST, 8.0), speed=15.0),
            lights=PROTECTED,
        ),
        situation(
            "sumo-on-minor-road-and-ego-passes",
            "The ego drives along the road with priority; a car from the minor road brakes.",
            TEE,
            going(TEE, HARBOUR, OUT_LEFT, 8.0, (0.0, 12.0)),
            Driven(route=along(TEE, OUT_LEFT, 6.0), speed=8.0, start_time=3.0),
        ),
        situation(
            "sumo-and-ego-at-all-way-stop",
            "The ego has stopped first at an all-way stop and goes; a later car brakes.",
            GRID,
            going(GRID, CASTLE_LEFT, SOUTH_WEST, 9.0, *pace(5.0, (3.5, 2.5, 0.0), (6.5, 2.0, 5.0))),
            Driven(route=along(GRID, SOUTH_WEST, 30.0), speed=8.0),
            seconds=18.0,
        ),
        situation(
            "sumo-at-the-entry-and-ego-circulates",
            "The ego circulates in the small roundabout; a car brakes at its entry.",
            RING,
            going(RING, FROM_EAST, ENTRY, 8.0, (0.0, 6.0)),
            Driven(route=along(RING, ENTRY, 68.0), speed=13.0),
        ),
        situation(
            "sumo-oncoming-turns-right-and-ego-turns-left",
            "The ego turns left into a road; an oncoming car brakes later to turn right into it.",
            HIGH,
            going(HIGH, INTO_CHAPEL, CHAPEL_IN, 7.0, *pace(5.5, (7.0, 1.0, 8.0))),
            Driven(route=along(HIGH, CHAPEL_IN, 45.0), speed=13.0),
        ),
        situation(
            "sumo-passes-later-and-ego-turns-left",
            "The ego turns left; a car that comes from the right passes five seconds later.",
            TEE,
            going(TEE, OUT_LEFT, HARBOUR, 6.5, *pace(6.0, (7.0, 1.0, 9.0))),
            Driven(route=along(TEE, HARBOUR, 1.0), speed=9.0, start_time=2.5),
        ),
    ]


def _near() -> list[Situation]:
    return [
        situation(
            "sumo-near-and-ego-comes-out-left",
            "The ego turns left 16 m before a car with priority, which brakes as hard as it can.",
            TEE,
            going(TEE, OUT_LEFT, HARBOUR, 8.0, (0.0, 5.0)),
            Driven(route=along(TEE, HARBOUR, 30.0), speed=12.0),
        ),
        situation(
            "sumo-near-and-ego-comes-out-slowly",
            "The ego turns left slowly; a car with priority, first 41 m away, brakes.",
            TEE,
            going(TEE, OUT_LEFT, HARBOUR, 8.0, (0.0, 4.0)),
            Driven(route=along(TEE, HARBOUR, 12.0), speed=12.0),
        ),
        situation(
            "sumo-near-and-ego-comes-out-right",
            "The ego turns right at low speed close before a car, which brakes behind it.",
            HIGH,
            going(HIGH, CHAPEL_RIGHT, VILLAGE_EAST, 8.0, *pace(4.5, (8.0, 0.7, 9.0))),
            Driven(route=along(HIGH, VILLAGE_EAST, 74.0), speed=13.0),
        ),
        situation(
            "sumo-changes-lanes-and-ego-comes-out-right",
            "The ego turns right 30 m before a car, which brakes and changes to the other lane.",
            ART,
            going(ART, ROSE, ROSE_MAIN, 8.0, (0.0, 5.0)),
            Driven(route=along(ART, ROSE_MAIN, 40.0), speed=16.0),
        ),
        situation(
            "sumo-oncoming-and-ego-turns-left",
            "The ego turns left across the way of an oncoming car, which brakes hard.",
            HIGH,
            going(HIGH, INTO_CHAPEL, VILLAGE_EAST, 8.0, (0.0, 4.5)),
            Driven(route=along(HIGH, VILLAGE_EAST, 72.0), speed=13.0),
        ),
        situation(
            "sumo-circulates-and-ego-enters",
            "The ego enters the small roundabout before a circulating car, which brakes.",
            RING,
            going(RING, ENTRY, FROM_EAST, 9.0, (0.0, 4.5)),
            Driven(route=along(RING, FROM_EAST, 73.0), speed=8.0),
        ),
        situation(
            "sumo-oncoming-and-ego-stands-across",
            "The ego stops across the oncoming lane behind a standing car; a car stops before it.",
            TEE,
            going(TEE, INTO_MILL, HARBOUR, 6.5, *pace(5.0, (6.2, 3.0, 0.0))),
            Driven(route=along(TEE, HARBOUR, 20.0), speed=11.0, start_time=1.0),
            standing(TEE, INTO_MILL, HARBOUR, -11.5, name="leader"),
        ),
        situation(
            "sumo-from-the-right-at-the-castle",
            "At a crossing without signs the ego comes from the left of a car, which brakes.",
            OLD,
            going(OLD, CLOISTER, CASTLE_HILL, 8.0, (0.0, 4.5)),
            Driven(route=along(OLD, CASTLE_HILL, 82.0), speed=8.0),
        ),
        situation(
            "sumo-second-of-two-and-ego-turns-left",
            "One car passes before the ego turns left; the next one brakes hard.",
            TEE,
            going(TEE, FERRY_LEFT, FERRY_MAIN, 9.4, (0.0, 5.0)),
            Car(
                drive=before(way(TEE, *FERRY_MAIN), (275.0, -6.0), 12.0, 6.6, (0.0, 11.0)),
                name="first",
            ),
            Driven(route=along(TEE, FERRY_MAIN, 118.0), speed=11.0, name="second"),
        ),
    ]


def situations() -> list[Situation]:
    """All of this kind."""
    return [*_far(), *_near()]
