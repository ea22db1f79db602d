"""Cases in which the front of a vehicle meets the rear of the ego ahead of it."""

from __future__ import annotations

from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case, Parked, Walker
from tests.oracles.responsibility.placing import (
    CARS,
    after,
    arc_of,
    beginning,
    beside,
    brisk,
    placed,
)
from tests.oracles.responsibility.ways import Drive, braking, cut, lanes, meeting, straight, sway

ARTERIAL, GRID, HIGHWAY = "arterial", "signal-grid", "highway"
OLD_TOWN, ROUND, RURAL, TEE = "old-town", "roundabout", "rural", "tee-town"
TRUCK, BUS = "vehicle.carlamotors.european_hgv", "vehicle.mitsubishi.fusorosa"
BICYCLE, MOTORCYCLE = "vehicle.gazelle.omafiets", "vehicle.yamaha.yzf"
SPRINTER = "vehicle.mercedes.sprinter"

_SECOND = straight((280.0, -1.62), (391.0, -1.62), (440.0, -1.62))


def _slowing() -> list[Case]:
    turn = lanes(ARTERIAL, "eb_hill_0", ":farm_5_0", "farm_s_0")
    onward = lanes(ARTERIAL, "eb_hill_0", ":farm_6_0", "eb_farm_0")
    station = lanes(
        ARTERIAL, "wb_hill_0", ":wb_station_pocket_0_0", "wb_hill_pocket_0", ":station_4_0"
    )
    exit_lane = lanes(HIGHWAY, "wb_b_decelerate_0", ":wb_b_off_0_0", "wb_b_exit_ramp_0")
    stop = lanes(TEE, "market_1_0", ":market_orchard_4_0", "market_2_0")
    entry = lanes(
        ROUND,
        "link_3_0",
        ":small_west_1_0",
        "small_west_entry_0",
        ":small_west_in_0_0",
        "small_ring_6_0",
    )
    ring = lanes(
        ROUND,
        "small_ring_3_0",
        ":small_north_in_1_0",
        "small_ring_4_0",
        ":small_west_out_1_0",
        "small_ring_5_0",
        ":small_west_in_1_0",
        "small_ring_6_0",
        ":small_south_out_1_0",
    )
    yellow = lanes(TEE, "high_1_0", ":high_mill_5_0", "high_2_0")
    return [
        placed(
            "ego-slows-for-its-right-turn-and-is-hit",
            "The ego slows down from 14 to 5 m/s over 3 s to turn right; a vehicle at 14 m/s "
            "behind does not slow down.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            ARTERIAL,
            after(
                turn,
                beginning(ARTERIAL, ":farm_5_0"),
                -12.0,
                8.0,
                (0.0, 14.0),
                (4.5, 14.0),
                (7.5, 5.0),
            ),
            brisk(
                drive=after(
                    onward, beginning(ARTERIAL, ":farm_5_0"), -12.0 - CARS, 8.0, (0.0, 14.0)
                )
            ),
        ),
        placed(
            "ego-stops-for-walker-on-crossing-and-is-hit",
            "The ego stops before a crossing for a pedestrian on it and is hit from behind by a "
            "van.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego, rear collision; RSS rule 1; Vienna 21",
            GRID,
            after(_SECOND, (391.0, -1.62), -6.0, 7.5, *braking(4.5, 8.0, 3.5)),
            brisk(
                drive=after(_SECOND, (391.0, -1.62), -6.0 - 5.4, 7.5, (0.0, 8.0)), model=SPRINTER
            ),
            Walker(points=((392.2, -5.5), (392.2, 5.5)), start_time=4.0, name="walker"),
        ),
        placed(
            "ego-waits-at-red-and-truck-hits-it-off-centre",
            "The ego has waited at a red light for 4 s; a truck, a metre to the right in the "
            "lane, hits its rear.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            ARTERIAL,
            after(
                station, beginning(ARTERIAL, ":station_4_0"), -4.0, 9.0, *braking(2.6, 10.0, 4.0)
            ),
            brisk(
                drive=after(
                    sway(station, 1.0, 12.0, -1.0),
                    beginning(ARTERIAL, ":station_4_0"),
                    -4.0 - 6.4,
                    9.0,
                    (0.0, 9.0),
                ),
                model=TRUCK,
            ),
            lights={"junctions": {"station": {"offset": -46.0}}},
        ),
        placed(
            "ego-slows-on-the-exit-ramp-and-is-hit",
            "On the exit lane the ego slows down from 26 to 15 m/s before the bend of the ramp; "
            "a vehicle at 25 m/s behind does not.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            HIGHWAY,
            after(
                exit_lane,
                beginning(HIGHWAY, "wb_b_exit_ramp_0"),
                20.0,
                8.5,
                (0.0, 26.0),
                (3.5, 26.0),
                (7.0, 15.0),
            ),
            brisk(
                drive=after(
                    exit_lane, beginning(HIGHWAY, "wb_b_exit_ramp_0"), 20.0 - CARS, 8.5, (0.0, 25.0)
                )
            ),
        ),
        placed(
            "ego-stops-at-all-way-stop-and-is-hit",
            "The ego stops at the line of an all-way stop; the vehicle behind brakes too late.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego / active rear collision; RSS rule 1",
            TEE,
            after(stop, beginning(TEE, ":market_orchard_4_0"), -3.5, 7.0, *braking(3.6, 8.0, 3.0)),
            brisk(
                drive=after(
                    stop,
                    beginning(TEE, ":market_orchard_4_0"),
                    -3.5 - CARS,
                    7.2,
                    (0.0, 9.0),
                    (6.4, 9.0),
                    (7.6, 3.0),
                )
            ),
        ),
        placed(
            "ego-gives-way-at-the-ring-and-is-hit",
            "The ego stops before the roundabout for a vehicle in it and is hit from behind.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego, rear collision; RSS rule 1",
            ROUND,
            after(
                entry, beginning(ROUND, ":small_west_in_0_0"), -3.5, 8.0, *braking(5.2, 7.0, 3.0)
            ),
            brisk(
                drive=after(
                    entry, beginning(ROUND, ":small_west_in_0_0"), -3.5 - CARS, 8.4, (0.0, 9.0)
                )
            ),
            brisk(
                drive=after(ring, beginning(ROUND, "small_ring_6_0"), -2.0, 8.0, (0.0, 6.0)),
                name="circulating",
            ),
        ),
        placed(
            "ego-stops-at-yellow-and-is-hit",
            "The ego stops at a light that has turned yellow 28 m before it; the vehicle 8 m "
            "behind drives on.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; Vienna art. 23 (yellow) and 13",
            TEE,
            after(yellow, beginning(TEE, ":high_mill_5_0"), -4.0, 9.0, *braking(5.8, 11.0, 4.0)),
            brisk(drive=after(yellow, beginning(TEE, ":high_mill_5_0"), -8.0, 8.0, (0.0, 11.0))),
            lights={"junctions": {"high_mill": {"offset": -35.0}}},
        ),
    ]


def _ego_ahead() -> list[Case]:
    lane = lanes(HIGHWAY, "wb_4_0", ":wb_b_on_0_0", "wb_b_accelerate_1")
    merge = lanes(HIGHWAY, "eb_b_entry_ramp_0", ":eb_b_on_3_0", "eb_b_accelerate_0")
    left = lanes(HIGHWAY, "eb_4_0", ":eb_b_on_0_0", "eb_b_accelerate_1")
    cut_at = arc_of(merge, beginning(HIGHWAY, "eb_b_accelerate_0"))
    bend = lanes(RURAL, "valley_16_0")
    second = lanes(HIGHWAY, "wb_1_1")
    queen = straight((12.0, 218.38), (120.0, 218.38))
    return [
        placed(
            "ego-drives-slowly-on-acceleration-lane-and-is-hit",
            "The ego drives at 13 m/s on the acceleration lane; a faster vehicle on the same "
            "lane runs into it.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; Vienna 13",
            HIGHWAY,
            Drive(way=lanes(HIGHWAY, "eb_a_accelerate_0"), speeds=((0.0, 13.0),)),
            brisk(
                drive=meeting(
                    lanes(HIGHWAY, "eb_a_entry_ramp_0", ":eb_a_on_0_0", "eb_a_accelerate_0"),
                    beside(HIGHWAY, "eb_a_accelerate_0", 98.0, 0.0),
                    8.0,
                    (0.0, 16.0),
                    (4.0, 16.0),
                    (7.0, 26.0),
                )
            ),
        ),
        placed(
            "ego-merged-just-now-and-is-hit",
            "The ego at 20 m/s moves from the acceleration lane to the lane beside it and is hit "
            "a second later by a vehicle at 32 m/s there.",
            AT_FAULT,
            "UNECE R157 cut-in; RSS rule 2; Vienna art. 14",
            HIGHWAY,
            Drive(
                way=cut(sway(merge, cut_at + 60.0, cut_at + 110.0, 3.75), cut_at - 5.0),
                speeds=((0.0, 20.0),),
            ),
            brisk(
                drive=meeting(
                    left, beside(HIGHWAY, "eb_b_accelerate_1", 102.4, 0.0), 5.6, (0.0, 32.0)
                )
            ),
            to=(2414.0, -11.9),
        ),
        placed(
            "ego-merged-long-ago-and-is-hit",
            "The ego merged 8 s ago, drives at 23 m/s in the right lane and is hit from behind "
            "by a vehicle at 33 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; R157 cut-in avoidable",
            HIGHWAY,
            Drive(
                way=sway(lanes(HIGHWAY, "wb_a_accelerate_0"), 4.0, 50.0, 3.75),
                speeds=((0.0, 22.0), (5.0, 23.0)),
            ),
            brisk(
                drive=meeting(
                    lanes(HIGHWAY, "wb_2_0", ":wb_a_on_1_0", "wb_a_accelerate_1"),
                    beside(HIGHWAY, "wb_a_accelerate_1", 221.0, 0.0),
                    10.0,
                    (0.0, 33.0),
                )
            ),
            to=(1507.0, 11.2),
        ),
        placed(
            "ego-on-highway-lane-passes-the-on-ramp-and-is-hit",
            "The ego drives at 21 m/s in the right lane, slows down to 17 m/s for a vehicle that "
            "comes from the ramp, and is hit by a truck at 24 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; Vienna art. 13",
            HIGHWAY,
            after(
                lane,
                beginning(HIGHWAY, ":wb_b_on_0_0"),
                15.0,
                9.0,
                (0.0, 21.0),
                (6.0, 21.0),
                (8.0, 17.0),
            ),
            brisk(
                drive=after(lane, beginning(HIGHWAY, ":wb_b_on_0_0"), 15.0 - 6.4, 9.0, (0.0, 24.0)),
                model=TRUCK,
            ),
            brisk(
                drive=after(
                    lanes(HIGHWAY, "wb_b_entry_ramp_0", ":wb_b_on_3_0", "wb_b_accelerate_0"),
                    beginning(HIGHWAY, "wb_b_accelerate_0"),
                    34.0,
                    9.0,
                    (0.0, 16.0),
                ),
                name="joining",
            ),
        ),
        placed(
            "ego-brakes-for-nothing-on-the-highway-and-is-hit",
            "The ego at 25 m/s brakes to 12 m/s on a free lane, 15 m ahead of a vehicle at the "
            "same speed, goes on, and is hit.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; Vienna art. 13 (distance)",
            HIGHWAY,
            Drive(
                way=cut(second, 24.7),
                speeds=((0.0, 25.0), (5.0, 25.0), (7.0, 12.0), (8.0, 14.0)),
            ),
            brisk(
                drive=Drive(way=cut(second, 5.0), speeds=((0.0, 25.0), (6.4, 25.0), (8.0, 19.0)))
            ),
        ),
        placed(
            "ego-hit-by-bus-in-bend",
            "In a bend the ego at 9 m/s is hit from behind by a bus at 15 m/s.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1",
            RURAL,
            meeting(bend, beside(RURAL, "valley_16_0", 130.0, 0.0), 8.0, (0.0, 9.0)),
            brisk(
                drive=meeting(bend, beside(RURAL, "valley_16_0", 122.4, 0.0), 8.0, (0.0, 15.0)),
                model=BUS,
            ),
        ),
        placed(
            "motorcycle-hits-creeping-ego",
            "The ego creeps at 2 m/s behind a queue; a motorcycle at 8 m/s runs into its right "
            "rear corner.",
            NOT_AT_FAULT,
            "nuPlan: active rear collision; RSS rule 1; Vienna art. 13",
            GRID,
            meeting(queen, (100.0, 218.38), 8.0, (0.0, 2.0)),
            brisk(
                drive=meeting(queen - [[0.0, 0.8]], (96.4, 217.6), 8.0, (0.0, 8.0)),
                model=MOTORCYCLE,
            ),
            Parked(at=(114.0, 218.38), name="queue"),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_slowing(), *_ego_ahead()]
