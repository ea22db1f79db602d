"""Further cases in junctions: two-lane ring, right before left, left turns, late yellow.

In ``roundabout`` the outer lane of the great ring leads out at the east and at the west. At
``church`` of ``old-town`` right goes before left.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.oracles.responsibility.case import (
    AT_FAULT,
    NOT_AT_FAULT,
    UNDETERMINED,
    Case,
    Ego,
    Walker,
)
from tests.oracles.responsibility.placing import after, beginning, beside, brisk, placed
from tests.oracles.responsibility.ways import Drive, braking, lanes, meeting, steady, straight

ARTERIAL, GRID, OLD_TOWN, ROUND, TEE = (
    "arterial",
    "signal-grid",
    "old-town",
    "roundabout",
    "tee-town",
)
YELLOW: Mapping[str, Any] = {"junctions": {"east_market": {"offset": -35.0}}}
"""At east_market: green for East Street until 5 s, yellow until 8 s, red for all until 10 s."""
CHANGING: Mapping[str, Any] = {"junctions": {"high_ferry": {"offset": -38.0}}}
"""At high_ferry: green for High Street until 2 s, yellow until 5 s; green for Ferry Street at 7."""


def _rings() -> list[Case]:
    inner = lanes(
        ROUND,
        *("great_ring_7_1", ":great_south_in_1_1", "great_ring_8_1", ":great_east_out_2_0"),
        *("great_ring_1_1", ":great_east_in_2_1", "great_ring_2_1", ":great_north_out_1_1"),
        *("great_ring_3_1", ":great_north_in_1_1", "great_ring_4_1"),
    )
    outer = lanes(
        ROUND,
        *("great_ring_1_0", ":great_east_in_2_0", "great_ring_2_0", ":great_north_out_1_0"),
        *("great_ring_3_0", ":great_north_in_1_0", "great_ring_4_0", ":great_west_out_0_0"),
        *("great_west_exit_0",),
    )
    entry = lanes(
        ROUND,
        *("-link_1_1", ":great_east_0_1", "great_east_entry_1", ":great_east_in_0_1"),
        "great_ring_2_1",
        ":great_north_out_1_1",
        "great_ring_3_1",
    )
    west_entry = lanes(
        ROUND,
        *("-west_1_1", ":great_west_2_1", "great_west_entry_1", ":great_west_in_0_1"),
        "great_ring_6_1",
        ":great_south_out_1_1",
        "great_ring_7_1",
    )
    west_ring = lanes(
        ROUND,
        *("great_ring_2_1", ":great_north_out_1_1", "great_ring_3_1", ":great_north_in_1_1"),
        *("great_ring_4_1", ":great_west_out_2_0", "great_ring_5_1", ":great_west_in_2_1"),
        *("great_ring_6_1", ":great_south_out_1_1", "great_ring_7_1"),
    )
    leaving = lanes(
        ROUND,
        *("great_ring_6_1", ":great_south_out_1_1", "great_ring_7_1", ":great_south_in_1_1"),
        *("great_ring_8_1", ":great_east_out_0_1", "great_east_exit_1", ":great_east_2_1"),
        *("link_1_1",),
    )
    staying = lanes(
        ROUND,
        *("great_ring_6_0", ":great_south_out_1_0", "great_ring_7_0", ":great_south_in_1_0"),
        *("great_ring_8_0", "great_ring_1_0", ":great_east_in_2_0", "great_ring_2_0"),
    )
    west_leaving = lanes(
        ROUND,
        *("great_ring_2_1", ":great_north_out_1_1", "great_ring_3_1", ":great_north_in_1_1"),
        *("great_ring_4_1", ":great_west_out_0_1", "great_west_exit_1", ":great_west_0_1"),
        *("west_1_1",),
    )
    west_staying = lanes(
        ROUND,
        *("great_ring_2_0", ":great_north_out_1_0", "great_ring_3_0", ":great_north_in_1_0"),
        *("great_ring_4_0", "great_ring_5_0", ":great_west_in_2_0", "great_ring_6_0"),
    )
    return [
        placed(
            "vehicle-enters-inner-ring-lane-before-ego",
            "A vehicle enters the two-lane roundabout from the left entry lane into the inner "
            "lane, right in front of the ego there.",
            NOT_AT_FAULT,
            "Vienna art. 18 (entry gives way, letter m); RSS rule 3",
            ROUND,
            after(inner, beginning(ROUND, "great_ring_2_1"), -2.0, 7.0, (0.0, 7.0)),
            brisk(drive=after(entry, beginning(ROUND, "great_ring_2_1"), -1.0, 7.0, (0.0, 6.0))),
        ),
        placed(
            "ego-enters-inner-ring-lane-before-vehicle",
            "The ego enters the two-lane roundabout from the left entry lane into the inner lane; "
            "a vehicle there brakes late and hits its left side.",
            AT_FAULT,
            "Vienna 18; RSS rule 3",
            ROUND,
            after(west_entry, beginning(ROUND, "great_ring_6_1"), -2.0, 8.0, (0.0, 6.0)),
            brisk(
                drive=after(
                    west_ring,
                    beginning(ROUND, "great_ring_6_1"),
                    -4.5,
                    8.0,
                    (0.0, 7.0),
                    (7.3, 7.0),
                    (8.5, 3.0),
                )
            ),
        ),
        placed(
            "ego-leaves-from-inner-lane-and-vehicle-stays-in-outer-lane",
            "The ego leaves the ring from the inner lane, as marked; a vehicle in the outer lane, "
            "which leads out there too, stays in the ring and hits it.",
            NOT_AT_FAULT,
            "nuPlan: lateral collision by the other leaving its lane; Vienna art. 10, 14",
            ROUND,
            after(leaving, beginning(ROUND, "great_east_exit_1"), -4.0, 6.5, (0.0, 7.0)),
            brisk(drive=after(staying, beginning(ROUND, "great_ring_1_0"), -3.5, 6.5, (0.0, 8.0))),
        ),
        placed(
            "ego-stays-in-outer-lane-and-vehicle-leaves-from-inner-lane",
            "The ego stays in the ring in the outer lane, which leads out there; a vehicle "
            "leaves from the inner lane across its way.",
            AT_FAULT,
            "nuPlan: active lateral/front collision while leaving its lane; Vienna art. 10, 14",
            ROUND,
            after(west_staying, beginning(ROUND, "great_ring_5_0"), -3.5, 6.5, (0.0, 7.0)),
            brisk(
                drive=after(
                    west_leaving, beginning(ROUND, "great_west_exit_1"), -3.5, 6.5, (0.0, 7.0)
                )
            ),
            to=(-60.0, 8.4),
        ),
        placed(
            "ego-stands-in-the-ring-and-is-hit",
            "The ego has stopped in the outer lane of the ring 3 s ago; a vehicle behind brakes "
            "late and hits it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego / active rear collision; RSS rule 1",
            ROUND,
            after(outer, beginning(ROUND, "great_ring_4_0"), 2.0, 7.0, *braking(2.0, 6.0, 3.0)),
            brisk(
                drive=after(
                    outer,
                    beginning(ROUND, "great_ring_4_0"),
                    2.0 - 5.2,
                    7.3,
                    (0.0, 7.0),
                    (6.8, 7.0),
                    (8.0, 2.0),
                )
            ),
        ),
    ]


def _giving_way() -> list[Case]:
    west = lanes(OLD_TOWN, "-west_street_1", ":church_4_0", "cloister_1")
    church = lanes(OLD_TOWN, "church_lane_1", ":church_0_0", "cloister_1")
    cloister = lanes(OLD_TOWN, "cloister_1", ":castle_2_0", "-castle_hill_1")
    street = lanes(OLD_TOWN, "-castle_street_1", ":castle_5_0", "-castle_hill_1")
    well = lanes(OLD_TOWN, "-castle_hill_1", ":well_1_0", "tanners_1")
    through = lanes(OLD_TOWN, "east_street_1", ":well_7_0", "gate_street_1")
    pocket = lanes(ARTERIAL, "eb_farm_pocket_2", ":school_13_0", "school_n_0")
    right = lanes(ARTERIAL, "wb_east_pocket_0", ":school_3_0", "school_n_0")
    orchard = lanes(TEE, "-orchard_1_0", ":market_orchard_1_0", "market_2_0")
    market = lanes(TEE, "-market_2_0", ":market_orchard_3_0", "-market_1_0")
    close = lanes(TEE, "-mill_2_0", ":mill_close_1_0", "close_1_0")
    mill = lanes(TEE, "mill_1_0", ":mill_close_5_0", "mill_2_0")
    halting = ((0.0, 6.0), (4.0, 6.0), (6.0, 0.0), (7.5, 0.0), (9.0, 4.0))
    return [
        placed(
            "ego-and-vehicle-from-its-right-at-church",
            "Where right goes before left, the ego drives straight on; a vehicle from its right "
            "turns right into the same road, and they meet.",
            AT_FAULT,
            "Vienna art. 18 (right before left, letters = and =) and 16",
            OLD_TOWN,
            after(west, beginning(OLD_TOWN, ":church_4_0"), 9.0, 8.0, (0.0, 7.0)),
            brisk(drive=after(church, beginning(OLD_TOWN, ":church_0_0"), 5.5, 8.0, (0.0, 5.0))),
        ),
        placed(
            "ego-from-the-right-turns-right-at-church",
            "Where right goes before left, the ego comes from the right and turns right; a "
            "vehicle that drives straight on meets it in the same road.",
            NOT_AT_FAULT,
            "Vienna art. 18 (right before left); nuPlan: active rear collision",
            OLD_TOWN,
            after(church, beginning(OLD_TOWN, ":church_0_0"), 7.0, 8.0, (0.0, 5.0)),
            brisk(drive=after(west, beginning(OLD_TOWN, ":church_4_0"), 6.0, 8.0, (0.0, 8.0))),
        ),
        Case(
            name="two-egos-meet-at-castle",
            happens="Where right goes before left, one ego drives straight on; the other comes "
            "from its right into the same road, and they meet.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source="Vienna art. 18 (right before left, letters = and M); RSS rule 3",
            town=OLD_TOWN,
            egos=(
                Ego(
                    drive=after(street, beginning(OLD_TOWN, ":castle_5_0"), 8.0, 8.0, (0.0, 6.0)),
                    to=beside(OLD_TOWN, "-castle_hill_1", 90.0, 0.0),
                ),
                Ego(
                    drive=after(cloister, beginning(OLD_TOWN, ":castle_2_0"), 4.0, 8.0, (0.0, 5.0)),
                    to=beside(OLD_TOWN, "-castle_hill_1", 90.0, 0.0),
                    name="second",
                ),
            ),
        ),
        placed(
            "ego-crosses-priority-road-in-town",
            "The ego crosses the road with priority at 6 m/s, brakes in the middle, and is hit "
            "by a vehicle from its right.",
            AT_FAULT,
            "Vienna 18; RSS rule 3",
            OLD_TOWN,
            after(
                well,
                beginning(OLD_TOWN, ":well_1_0"),
                11.5,
                8.0,
                (0.0, 6.0),
                (7.0, 6.0),
                (8.2, 0.5),
            ),
            brisk(drive=after(through, beginning(OLD_TOWN, ":well_7_0"), 5.0, 8.0, (0.0, 8.0))),
        ),
        placed(
            "ego-turns-left-and-oncoming-turns-right-into-the-same-road",
            "On a green that does not protect it, the ego turns left; an oncoming vehicle turns "
            "right into the same road, and they meet there.",
            AT_FAULT,
            "Vienna art. 16, 18 (left turn gives way to oncoming traffic); signal g against G",
            ARTERIAL,
            after(pocket, beginning(ARTERIAL, "school_n_0"), 1.0, 8.0, (0.0, 6.0)),
            brisk(drive=after(right, beginning(ARTERIAL, "school_n_0"), -2.0, 8.0, (0.0, 5.0))),
        ),
        Case(
            name="two-egos-start-at-the-same-time-at-all-way-stop",
            happens="Two egos stop at the lines of an all-way stop at the same time and start at "
            "the same time; the first comes from the right of the second.",
            expected=UNDETERMINED,
            expected_of={"second": UNDETERMINED},
            source="All-way stop: arrival order, equal times; Vienna 18",
            town=TEE,
            egos=(
                Ego(
                    drive=after(
                        orchard, beginning(TEE, ":market_orchard_1_0"), -3.0, 6.5, *halting
                    ),
                    to=(190.0, 280.9),
                ),
                Ego(
                    drive=after(market, beginning(TEE, ":market_orchard_3_0"), -3.0, 6.5, *halting),
                    to=(10.0, 289.3),
                    name="second",
                ),
            ),
        ),
        placed(
            "ego-turns-left-into-close-before-oncoming",
            "The ego turns left into a close at 5 m/s; an oncoming vehicle at 13 m/s, where 11 "
            "are allowed, hits its right side.",
            AT_FAULT,
            "Vienna art. 16, 18 (left turn gives way to oncoming traffic); RSS rule 3",
            TEE,
            after(close, beginning(TEE, ":mill_close_1_0"), 9.0, 6.0, (0.0, 5.0)),
            brisk(drive=after(mill, beginning(TEE, ":mill_close_5_0"), 4.0, 6.0, (0.0, 13.0))),
        ),
    ]


def _signals() -> list[Case]:
    east = lanes(TEE, "east_1_0", ":east_market_3_0", "-market_4_0")
    east_on = lanes(TEE, "east_1_0", ":east_market_2_0", "north_1_0")
    north = lanes(TEE, "-north_1_0", ":east_market_1_0", "-east_1_0")
    ferry = lanes(TEE, "ferry_1_0", ":high_ferry_3_0", "-high_3_0")
    high = lanes(TEE, "-high_4_0", ":high_ferry_0_0", "-high_3_0")
    bridge = lanes(GRID, "bridge_1_2", ":c2_11_0", "-grand_2_2")
    down = straight((260.12, 200.0), (260.12, 20.0))
    grand = straight((150.0, 105.12), (380.0, 105.12))
    market = lanes(OLD_TOWN, "south_street_1", ":market_7_0", "church_lane_1")
    del east_on, market
    return [
        placed(
            "ego-passes-late-yellow-and-oncoming-turns-left",
            "The ego enters the junction at the end of yellow; an oncoming vehicle that "
            "has slowed down in the junction turns left into its way.",
            NOT_AT_FAULT,
            "Vienna 16, 18 (left turn gives way); RSS rule 3",
            TEE,
            after(north, beginning(TEE, ":east_market_1_0"), 5.0, 8.2, (0.0, 11.0)),
            brisk(
                drive=after(
                    east,
                    beginning(TEE, ":east_market_3_0"),
                    4.5,
                    6.5,
                    (0.0, 7.0),
                    (3.0, 7.0),
                    (5.5, 0.8),
                    (7.2, 0.8),
                    (8.4, 4.0),
                )
            ),
            lights=YELLOW,
        ),
        placed(
            "ego-turns-left-at-end-of-yellow-before-oncoming-on-red",
            "The ego waited in the junction and turns left when the light turns red; an oncoming "
            "vehicle passes its red light and hits it.",
            NOT_AT_FAULT,
            "Vienna 23 (other's red); RSS rule 3",
            TEE,
            after(
                east,
                beginning(TEE, ":east_market_3_0"),
                4.5,
                7.5,
                (0.0, 7.0),
                (4.0, 7.0),
                (6.5, 0.0),
                (8.0, 0.0),
                (9.2, 4.0),
            ),
            brisk(drive=after(north, beginning(TEE, ":east_market_1_0"), 8.0, 9.7, (0.0, 11.0))),
            lights=YELLOW,
        ),
        placed(
            "ego-rolls-into-junction-on-new-green-and-hits-vehicle-that-clears",
            "The ego reaches the line at 7 m/s as its light turns green and hits a slow vehicle "
            "that entered on yellow.",
            AT_FAULT,
            "RSS rule 3 (right of way is given, not taken); Vienna art. 18/23 (let those in "
            "the junction clear it)",
            TEE,
            after(ferry, beginning(TEE, ":high_ferry_3_0"), 9.0, 8.4, (0.0, 7.0)),
            brisk(
                drive=after(
                    high,
                    beginning(TEE, ":high_ferry_0_0"),
                    9.0,
                    8.2,
                    (0.0, 8.0),
                    (3.0, 8.0),
                    (5.0, 2.5),
                )
            ),
            lights=CHANGING,
        ),
        placed(
            "ego-waits-in-junction-to-turn-left-and-cross-traffic-starts",
            "The ego still stands in the junction to turn left when its light has turned red; a "
            "vehicle from the left, on new green, hits it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 3 (right of way is given, not taken); Vienna art. 18",
            GRID,
            after(
                bridge, beginning(GRID, ":c2_11_0"), 5.5, 5.0, (0.0, 7.0), (1.5, 7.0), (4.0, 0.0)
            ),
            brisk(drive=meeting(grand, (262.5, 105.12), 10.5, (0.0, 7.0))),
            brisk(drive=meeting(down, (260.12, 124.0), 2.0, (0.0, 10.0)), name="oncoming"),
            lights={"junctions": {"c2": {"offset": -22.0}}},
        ),
        placed(
            "ego-on-red-and-walker-on-green-crossing",
            "The ego passes a red light, brakes in the last half second and hits a pedestrian "
            "on the crossing right after the line, which has green.",
            AT_FAULT,
            "Vienna 21, 23; nuPlan active front collision",
            GRID,
            meeting(
                straight((160.0, 218.38), (300.0, 218.38)),
                (251.0, 218.38),
                8.0,
                (0.0, 8.0),
                (7.4, 8.0),
                (8.6, 2.0),
            ),
            Walker(points=((254.0, 224.5), (254.0, 214.0)), start_time=3.9),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_rings(), *_giving_way(), *_signals()]


_ = (Drive, steady)
