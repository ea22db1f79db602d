"""Cases beside a border between edges, lanes or junctions that one of the two has just passed.

The edges of ``arterial`` are divided where pockets begin, those of ``rural`` where the limit
changes, those of ``highway`` at the ramps, those of ``roundabout`` at each entry and exit.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case, Parked
from tests.oracles.responsibility.placing import CARS, after, arc_of, beginning, brisk, placed
from tests.oracles.responsibility.ways import lanes, sway

ARTERIAL, GRID, HIGHWAY = "arterial", "signal-grid", "highway"
OLD_TOWN, ROUND, RURAL, TEE = "old-town", "roundabout", "rural", "tee-town"
TRUCK, CENTURY = "vehicle.carlamotors.european_hgv", "vehicle.diamondback.century"

_POCKET = tuple(
    lanes(ARTERIAL, f"eb_mill_{n}", f":eb_station_pocket_0_{n}", f"eb_mill_pocket_{n}")
    for n in (0, 1)
)
_INNER = lanes(
    ROUND,
    *("great_ring_6_1", ":great_south_out_1_1", "great_ring_7_1", ":great_south_in_1_1"),
    *("great_ring_8_1", ":great_east_out_2_0", "great_ring_1_1", ":great_east_in_2_1"),
    *("great_ring_2_1", ":great_north_out_1_1", "great_ring_3_1", ":great_north_in_1_1"),
    *("great_ring_4_1", ":great_west_out_0_1", "great_west_exit_1"),
)
_OUTER = lanes(
    ROUND,
    *("great_west_entry_0", ":great_west_in_0_0", "great_ring_6_0", ":great_south_out_1_0"),
    *("great_ring_7_0", ":great_south_in_1_0", "great_ring_8_0", ":great_east_out_0_0"),
    "great_east_exit_0",
)
_SMALL = lanes(
    ROUND,
    *("small_ring_7_0", ":small_south_in_1_0", "small_ring_8_0", ":small_east_out_1_0"),
    *("small_ring_1_0", ":small_east_in_1_0", "small_ring_2_0", ":small_north_out_0_0"),
    *("small_north_exit_0", ":small_north_1_0", "-north_3_0"),
)


def _ego_is_hit() -> list[Case]:
    pocket = (349.3, -7.75)
    exit_lane = lanes(HIGHWAY, "eb_1_2", ":eb_a_exit_0_2", "eb_a_decelerate_3")
    bend = lanes(RURAL, "valley_14_0", ":valley_limit_14_0_0", "valley_15_0")
    limit = beginning(RURAL, "valley_15_0")
    street = lanes(GRID, "bridge_2_2", ":c3_8_1", "bridge_3_2")
    lane_end = lanes(HIGHWAY, "eb_a_accelerate_1", ":eb_a_merged_0_0", "eb_3_0")
    ramp = lanes(HIGHWAY, "wb_b_entry_ramp_0", ":wb_b_on_3_0", "wb_b_accelerate_0")
    neck = lanes(ROUND, "-link_3_0", ":vale_north_0_0", "-link_2_0", ":link_neck_0_0", "-link_1_1")
    onward = lanes(ARTERIAL, "eb_station_0", ":rose_2_0", "eb_rose_0")
    into = lanes(ARTERIAL, "eb_station_0", ":rose_1_0", "rose_s_0")
    wall = lanes(OLD_TOWN, "wall_4_1", ":gate_west_0_0", "wall_5_1", ":gate_mill_0_0", "wall_6_1")
    return [
        placed(
            "ego-passes-from-edge-into-pocket-junction-and-is-hit",
            "The ego drives straight on at 6 m/s and is hit from behind at 13 m/s just after it "
            "has passed the end of the edge.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ARTERIAL,
            after(_POCKET[0], pocket, 1.8, 7.0, (0.0, 6.0)),
            brisk(drive=after(_POCKET[0], pocket, 1.8 - CARS, 7.0, (0.0, 13.0))),
        ),
        placed(
            "ego-passes-where-exit-lane-is-added-and-is-hit",
            "On the highway the ego at 22 m/s is hit from behind at 32 m/s just where its lane "
            "goes on beside an added exit lane.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            HIGHWAY,
            after(exit_lane, beginning(HIGHWAY, ":eb_a_exit_0_2"), 8.0, 8.0, (0.0, 22.0)),
            brisk(
                drive=after(
                    exit_lane, beginning(HIGHWAY, ":eb_a_exit_0_2"), 8.0 - CARS, 8.0, (0.0, 32.0)
                )
            ),
        ),
        placed(
            "ego-passes-limit-border-in-bend-and-is-hit",
            "In a bend the ego at 10 m/s is hit from behind at 16 m/s just after the place where "
            "the speed limit changes.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            RURAL,
            after(bend, limit, 2.5, 8.0, (0.0, 10.0)),
            brisk(drive=after(bend, limit, 2.5 - CARS, 8.0, (0.0, 16.0))),
        ),
        placed(
            "ego-passes-entry-in-inner-ring-and-is-hit",
            "The ego circulates at 5 m/s in the inner lane of the roundabout and is hit from "
            "behind just as it passes an entry.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ROUND,
            after(_INNER, beginning(ROUND, ":great_north_in_1_1"), 1.2, 7.0, (0.0, 5.0)),
            brisk(
                drive=after(
                    _INNER, beginning(ROUND, ":great_north_in_1_1"), 1.2 - CARS, 7.0, (0.0, 9.0)
                )
            ),
        ),
        placed(
            "ego-leaves-small-ring-and-is-hit",
            "The ego leaves the small roundabout at 5 m/s and is hit from behind just as it "
            "reaches the exit road.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ROUND,
            after(_SMALL, beginning(ROUND, "small_north_exit_0"), 1.5, 6.0, (0.0, 5.0)),
            brisk(
                drive=after(
                    _SMALL, beginning(ROUND, "small_north_exit_0"), 1.5 - CARS, 6.0, (0.0, 8.0)
                )
            ),
        ),
        placed(
            "ego-enters-signalised-junction-on-green-and-is-hit",
            "The ego drives straight on at 7 m/s on green and is hit from behind at 13 m/s just "
            "as it enters the junction.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            GRID,
            after(street, beginning(GRID, ":c3_8_1"), 2.0, 6.0, (0.0, 7.0)),
            brisk(drive=after(street, beginning(GRID, ":c3_8_1"), 2.0 - CARS, 6.0, (0.0, 13.0))),
        ),
        placed(
            "ego-passes-end-of-lane-beside-it-and-is-hit",
            "The ego stays in its lane at 24 m/s where the lane to its right ends, and is hit "
            "from behind at 33 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            HIGHWAY,
            after(lane_end, beginning(HIGHWAY, ":eb_a_merged_0_0"), 8.0, 7.0, (0.0, 24.0)),
            brisk(
                drive=after(
                    lane_end, beginning(HIGHWAY, ":eb_a_merged_0_0"), 8.0 - CARS, 7.0, (0.0, 33.0)
                )
            ),
        ),
        placed(
            "ego-comes-from-ramp-into-its-own-lane-and-is-hit",
            "The ego at 12 m/s passes from the ramp into the acceleration lane that begins there "
            "and is hit by a faster vehicle from the ramp.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            HIGHWAY,
            after(ramp, beginning(HIGHWAY, "wb_b_accelerate_0"), 3.5, 8.0, (0.0, 12.0)),
            brisk(
                drive=after(
                    ramp, beginning(HIGHWAY, "wb_b_accelerate_0"), 8.0 - CARS, 8.0, (0.0, 19.0)
                )
            ),
        ),
        placed(
            "ego-passes-where-road-widens-and-is-hit",
            "Where one lane becomes two, the ego drives straight on at 6 m/s and is hit from "
            "behind at 12 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ROUND,
            after(neck, beginning(ROUND, ":link_neck_0_0"), 1.5, 8.0, (0.0, 6.0)),
            brisk(
                drive=after(neck, beginning(ROUND, ":link_neck_0_0"), 1.5 - CARS, 8.0, (0.0, 12.0))
            ),
        ),
        placed(
            "ego-begins-its-right-turn-and-is-hit",
            "The ego at 5 m/s has just entered the junction to turn right and is hit from behind "
            "at 12 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ARTERIAL,
            after(into, beginning(ARTERIAL, ":rose_1_0"), 1.5, 8.0, (0.0, 5.0)),
            brisk(
                drive=after(onward, beginning(ARTERIAL, ":rose_1_0"), 1.5 - CARS, 8.0, (0.0, 12.0))
            ),
        ),
        placed(
            "ego-comes-out-of-junction-and-is-hit-by-motorcycle",
            "The ego at 6 m/s has just left the junction on the ring road and is hit from behind "
            "by a motorcycle at 11 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            OLD_TOWN,
            after(wall, beginning(OLD_TOWN, "wall_5_1"), 1.5, 7.0, (0.0, 6.0)),
            brisk(
                drive=after(wall, beginning(OLD_TOWN, "wall_5_1"), 1.5 - 3.5, 7.0, (0.0, 11.0)),
                model="vehicle.kawasaki.ninja",
            ),
        ),
    ]


def _ego_hits() -> list[Case]:
    lane_added = (361.0, -4.25)
    bend = lanes(RURAL, "valley_20_0", ":valley_limit_20_0_0", "valley_21_0")
    corner = lanes(TEE, "harbour_2_0", ":east_high_2_0", "east_1_0")
    left = lanes(TEE, "west_2_0", ":west_high_5_0", "high_1_0")
    straight_on = lanes(TEE, "west_2_0", ":west_high_4_0", "harbour_0_0")
    market = lanes(TEE, "market_3_0", ":market_station_4_0", "market_4_0")
    return [
        placed(
            "vehicle-ahead-comes-out-of-pocket-junction",
            "The ego at 14 m/s hits a vehicle at 5 m/s that has just passed straight on into the "
            "next edge, which has one lane more.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1",
            ARTERIAL,
            after(_POCKET[1], lane_added, 1.5 - CARS, 6.0, (0.0, 14.0)),
            brisk(drive=after(_POCKET[1], lane_added, 1.5, 6.0, (0.0, 5.0))),
        ),
        placed(
            "bicycle-ahead-passes-limit-border-in-bend",
            "The ego at 12 m/s hits a bicycle at 4 m/s in a bend, just where the speed limit "
            "changes.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1",
            RURAL,
            after(bend, beginning(RURAL, "valley_21_0"), 1.2 - 3.3, 9.0, (0.0, 12.0)),
            brisk(
                drive=after(bend, beginning(RURAL, "valley_21_0"), 1.2, 9.0, (0.0, 4.0)),
                model=CENTURY,
            ),
        ),
        placed(
            "vehicle-ahead-passes-exit-in-outer-ring",
            "In the outer lane of the roundabout the ego at 8 m/s hits a vehicle at 3.5 m/s that "
            "stays in the ring and has just reached an exit.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1",
            ROUND,
            after(_OUTER, beginning(ROUND, ":great_south_out_1_0"), 1.0 - CARS, 7.0, (0.0, 8.0)),
            brisk(
                drive=after(_OUTER, beginning(ROUND, ":great_south_out_1_0"), 1.0, 7.0, (0.0, 3.5))
            ),
        ),
        placed(
            "vehicle-ahead-comes-out-of-t-junction",
            "The ego at 10 m/s hits a vehicle at 4 m/s that has just left the junction straight "
            "on.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1",
            TEE,
            after(corner, beginning(TEE, "east_1_0"), 1.2 - CARS, 7.0, (0.0, 10.0)),
            brisk(drive=after(corner, beginning(TEE, "east_1_0"), 1.2, 7.0, (0.0, 4.0))),
        ),
        placed(
            "vehicle-ahead-begins-its-left-turn",
            "The ego wants to drive straight on at 11 m/s and hits a vehicle at 3 m/s that has "
            "just entered the junction to turn left.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1",
            TEE,
            after(straight_on, beginning(TEE, ":west_high_5_0"), 1.0 - CARS, 8.0, (0.0, 11.0)),
            brisk(drive=after(left, beginning(TEE, ":west_high_5_0"), 1.0, 8.0, (0.0, 3.0))),
        ),
        placed(
            "truck-ahead-enters-signalised-junction-on-green",
            "The ego at 11 m/s hits a truck at 4 m/s that has just entered the junction on green.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna 13",
            TEE,
            after(market, beginning(TEE, ":market_station_4_0"), 1.2 - 6.4, 6.0, (0.0, 11.0)),
            brisk(
                drive=after(market, beginning(TEE, ":market_station_4_0"), 1.2, 6.0, (0.0, 4.0)),
                model=TRUCK,
            ),
        ),
    ]


def _sides() -> list[Case]:
    beside_left = lanes(ARTERIAL, "eb_station_1", ":rose_2_1", "eb_rose_1")
    beside_right = lanes(ARTERIAL, "eb_station_0", ":rose_2_0", "eb_rose_0")
    begin = arc_of(beside_right, (597.0, -7.75))
    west = lanes(ARTERIAL, "wb_hill_0", ":wb_station_pocket_0_0", "wb_hill_pocket_0")
    west_left = lanes(ARTERIAL, "wb_hill_1", ":wb_station_pocket_0_1", "wb_hill_pocket_1")
    onward = lanes(RURAL, "valley_7_0", ":valley_limit_7_1_0", "valley_8_0")
    coming = lanes(RURAL, "-valley_8_0", ":valley_limit_7_0_0", "-valley_7_0", left=1.9)
    border = beginning(RURAL, "valley_8_0")
    over = lanes(RURAL, "valley_1_0", ":valley_limit_1_1_0", "valley_2_0", left=1.9)
    kept = lanes(RURAL, "-valley_2_0", ":valley_limit_1_0_0", "-valley_1_0")
    passed = beginning(RURAL, "-valley_1_0")
    return [
        placed(
            "vehicle-beside-ego-drifts-over-at-junction-border",
            "The ego drives straight on in the left lane and has just entered the junction when "
            "the vehicle to its right drifts over the line and touches it.",
            NOT_AT_FAULT,
            "nuPlan: active lateral by the other; Vienna art. 14",
            ARTERIAL,
            after(beside_left, (611.0, -4.25), 5.5, 8.0, (0.0, 12.0)),
            brisk(
                drive=after(
                    sway(beside_right, begin, begin + 30.0, 2.4),
                    (611.0, -6.0),
                    5.0,
                    8.0,
                    (0.0, 12.0),
                )
            ),
        ),
        placed(
            "ego-drifts-over-at-pocket-border",
            "The ego drifts over the line to its left just where the edges change and touches "
            "the vehicle there, which drives straight on.",
            AT_FAULT,
            "nuPlan: active lateral collision while leaving the lane; Vienna art. 14",
            ARTERIAL,
            after(
                sway(west, arc_of(west, (564.0, 7.75)), arc_of(west, (534.0, 7.75)), 2.4),
                (545.5, 6.0),
                0.0,
                8.0,
                (0.0, 13.0),
            ),
            brisk(drive=after(west_left, (545.5, 4.25), 0.8, 8.0, (0.0, 13.0))),
        ),
        placed(
            "oncoming-over-the-line-at-limit-border",
            "An oncoming vehicle half over the line touches the ego's left front corner just "
            "after the ego has passed the place where the limit changes.",
            NOT_AT_FAULT,
            "RSS rule 1 opposite directions; Vienna 10, 12",
            RURAL,
            after(onward, border, 2.5, 4.5, (0.0, 12.0)),
            brisk(drive=after(coming, border, -2.5 - CARS, 4.5, (0.0, 15.0))),
        ),
        placed(
            "ego-over-the-line-at-limit-border",
            "The ego drives half over the line and touches an oncoming vehicle that has just "
            "passed the place where the limit changes.",
            AT_FAULT,
            "RSS rule 1 opposite directions; Vienna 10, 12",
            RURAL,
            after(over, passed, -2.5 - CARS, 6.0, (0.0, 14.0)),
            brisk(drive=after(kept, passed, 2.5, 6.0, (0.0, 13.0))),
        ),
    ]


def _lane_changes() -> list[Case]:
    rose = lanes(ARTERIAL, "eb_rose_0", ":eb_hill_pocket_0_0", "eb_rose_pocket_0")
    rose_left = lanes(
        ARTERIAL,
        *("eb_station_1", ":rose_2_1", "eb_rose_1", ":eb_hill_pocket_0_1", "eb_rose_pocket_1"),
    )
    first = arc_of(rose, (674.5, -7.75))
    right = lanes(HIGHWAY, "wb_1_0", ":wb_a_exit_0_0", "wb_a_decelerate_1")
    middle = lanes(HIGHWAY, "wb_1_1", ":wb_a_exit_0_1", "wb_a_decelerate_2")
    border = beginning(HIGHWAY, ":wb_a_exit_0_0")
    turn = arc_of(middle, border)
    farm = lanes(ARTERIAL, "wb_farm_1", ":wb_hill_pocket_0_1", "wb_farm_pocket_1")
    return [
        placed(
            "ego-changes-lanes-at-pocket-border",
            "The ego at 7 m/s changes to the left lane just where the edges change, a few metres "
            "ahead of a vehicle at 14 m/s, which hits it.",
            AT_FAULT,
            "RSS rule 2; UNECE R157 annex 3; Vienna art. 11, 14",
            ARTERIAL,
            after(sway(rose, first, first + 14.0, 3.5), (681.0, -5.0), 3.0, 6.0, (0.0, 7.0)),
            brisk(drive=after(rose_left, (681.0, -4.25), 3.0 - CARS, 6.0, (0.0, 14.0))),
        ),
        placed(
            "vehicle-changes-lanes-at-exit-border",
            "A vehicle at 20 m/s changes into the lane of the ego at 30 m/s just where the exit "
            "lane is added, and the ego hits it.",
            NOT_AT_FAULT,
            "R157 annex 3: not avoidable; RSS rule 2; Vienna 14",
            HIGHWAY,
            after(right, border, 6.0 - CARS, 8.0, (0.0, 30.0)),
            brisk(
                drive=after(
                    sway(middle, turn - 35.0, turn + 5.0, -3.75), border, 6.0, 8.0, (0.0, 20.0)
                )
            ),
        ),
        placed(
            "ego-moves-into-new-pocket-behind-waiting-vehicle",
            "The ego moves left into the pocket that begins there and runs into a vehicle that "
            "waits in it.",
            AT_FAULT,
            "nuPlan: stopped track; RSS rule 1; Vienna art. 14",
            ARTERIAL,
            after(
                sway(farm, arc_of(farm, (884.0, 4.25)), arc_of(farm, (862.0, 4.25)), 3.5),
                (866.0, 1.5),
                0.0,
                7.0,
                (0.0, 9.0),
            ),
            Parked(at=(860.5, 0.75), yaw=180.0),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_ego_is_hit(), *_ego_hits(), *_sides(), *_lane_changes()]
