"""Further cases on roads: ends of lanes, turning round, overtaking, standing, two egos."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case, Ego
from tests.oracles.responsibility.placing import (
    after,
    arc_of,
    beginning,
    beside,
    brisk,
    placed,
)
from tests.oracles.responsibility.ways import (
    Drive,
    Point,
    cut,
    lanes,
    meeting,
    steady,
    sway,
)

ARTERIAL, GRID, HIGHWAY = "arterial", "signal-grid", "highway"
OLD_TOWN, ROUND, RURAL, TEE = "old-town", "roundabout", "rural", "tee-town"
BICYCLE, BUS = "vehicle.gazelle.omafiets", "vehicle.mitsubishi.fusorosa"
SPRINTER, TRUCK = "vehicle.mercedes.sprinter", "vehicle.carlamotors.european_hgv"


def round_turn(start: Point, before: float, radius: float) -> FloatArray:
    """East, a half circle to the left, and west."""
    x, y = start
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 25)
    arc = np.column_stack(
        (x + before + radius * np.cos(angles), y + radius + radius * np.sin(angles))
    )
    return np.vstack(((x, y), arc, (x - 20.0, y + 2.0 * radius)))


def _ends_of_lanes() -> list[Case]:
    ending = lanes(HIGHWAY, "wb_a_accelerate_0")
    staying = lanes(HIGHWAY, "wb_a_accelerate_1", ":wb_a_merged_0_0", "wb_3_0")
    east_end = lanes(HIGHWAY, "eb_b_accelerate_0")
    east_stay = lanes(HIGHWAY, "eb_b_accelerate_1", ":eb_b_merged_0_0", "eb_5_0")
    neck_end = lanes(ROUND, "link_1_0")
    neck = lanes(ROUND, "link_1_1", ":link_neck_1_0", "link_2_0")
    west_end = lanes(ROUND, "west_1_0")
    west = lanes(ROUND, "west_1_1", ":west_neck_0_0", "west_2_0")
    return [
        placed(
            "other-leaves-ending-lane-into-ego-beside-it",
            "The ego stays in its lane; a vehicle beside it, on the acceleration lane that ends "
            "there, moves over into the ego's side.",
            NOT_AT_FAULT,
            "nuPlan: active lateral by the other; Vienna art. 14; RSS rule 2",
            HIGHWAY,
            steady(cut(staying, 110.0), 20.0),
            brisk(drive=steady(cut(sway(ending, 225.0, 280.0, 3.75), 111.0), 20.0)),
        ),
        placed(
            "ego-leaves-ending-lane-before-vehicle-behind",
            "At the end of the acceleration lane the ego moves over; a vehicle half a length "
            "behind it in the next lane touches its left side.",
            AT_FAULT,
            "RSS rule 2; Vienna 14; nuPlan active lateral while leaving the lane",
            HIGHWAY,
            steady(cut(sway(east_end, 215.0, 275.0, 3.75), 100.0), 19.0),
            brisk(drive=steady(cut(east_stay, 96.0), 19.5)),
            to=(2414.0, -11.9),
        ),
        placed(
            "other-leaves-ending-lane-half-a-length-ahead-of-ego",
            "Where two lanes become one, a vehicle in the ending lane moves over half a length "
            "ahead of the ego, which keeps its speed and touches it.",
            NOT_AT_FAULT,
            "RSS rule 2; Vienna 14; R157 annex 3: not avoidable",
            ROUND,
            steady(neck, 9.0),
            brisk(drive=steady(cut(sway(neck_end, 44.0, 78.0, 3.4), 3.0), 9.0)),
        ),
        placed(
            "ego-leaves-ending-lane-into-truck",
            "Where two lanes become one, the ego in the ending lane moves over into the side of "
            "a truck in the other lane.",
            AT_FAULT,
            "nuPlan: active lateral while leaving the lane; RSS rule 2; Vienna 14",
            ROUND,
            steady(cut(sway(west_end, 42.0, 78.0, 3.4), 2.0), 10.0),
            brisk(drive=steady(west, 10.0), model=TRUCK),
            to=(-178.0, 1.75),
        ),
    ]


def _turning_round_and_overtaking() -> list[Case]:
    kerb = round_turn((985.0, -168.4), 55.0, 4.6)
    south = lanes(ARTERIAL, "south_hill_0", ":farm_south_4_0", "south_farm_0")
    pulling = round_turn((650.0, -168.6), 60.0, 4.6)
    rose = lanes(ARTERIAL, "south_station_0", ":rose_south_4_0", "south_rose_0")
    ridge = lanes(RURAL, "valley_17_0", ":valley_limit_17_0_0", "valley_18_0")
    passing = lanes(
        RURAL,
        "valley_17_0",
        ":valley_limit_17_0_0",
        "valley_18_0",
        ":ridge_north_0_0",
        "valley_19_0",
    )
    turning = lanes(
        RURAL,
        "valley_17_0",
        ":valley_limit_17_0_0",
        "valley_18_0",
        ":ridge_north_1_0",
        "-ridge_2_0",
    )
    begin = arc_of(ridge, beginning(RURAL, "valley_18_0"))
    quarry = lanes(
        RURAL,
        "-valley_13_0",
        ":valley_limit_12_0_0",
        "-valley_12_0",
        ":quarry_1_0",
        "quarry_track_0",
    )
    beyond = lanes(
        RURAL, "-valley_13_0", ":valley_limit_12_0_0", "-valley_12_0", ":quarry_0_0", "-valley_11_0"
    )
    start = arc_of(beyond, beginning(RURAL, "-valley_12_0"))
    wall = lanes(OLD_TOWN, "wall_6_1")
    stop = lanes(TEE, "-harbour_2_0")
    return [
        placed(
            "ego-turns-round-from-the-kerb-before-vehicle-behind",
            "The ego slows at the right edge of the road and turns round to the left; a vehicle "
            "from behind hits its left side.",
            AT_FAULT,
            "Vienna 14 (U-turn); RSS rule 2",
            ARTERIAL,
            Drive(way=kerb, speeds=((0.0, 10.0), (3.0, 10.0), (5.5, 4.0))),
            brisk(drive=meeting(south, (1039.0, -166.75), 8.6, (0.0, 13.0))),
            to=(1110.0, -166.75),
            seconds=10.0,
        ),
        placed(
            "vehicle-turns-round-from-the-kerb-before-ego",
            "A vehicle at the right edge of the road turns round to the left in front of the "
            "ego, which comes from behind and brakes in the last half second.",
            NOT_AT_FAULT,
            "Vienna art. 14 (U-turn); UNECE R157 annex 3",
            ARTERIAL,
            meeting(rose, (708.5, -166.75), 9.1, (0.0, 13.0), (8.5, 13.0), (9.9, 5.0)),
            brisk(drive=Drive(way=pulling, speeds=((0.0, 10.0), (3.5, 10.0), (6.0, 4.0)))),
        ),
        placed(
            "ego-overtakes-vehicle-that-turns-left",
            "The ego overtakes before a junction on the country road; the vehicle that it "
            "overtakes turns left into its side.",
            NOT_AT_FAULT,
            "Vienna art. 14/16 (the turning driver must make sure of those behind); nuPlan: "
            "active lateral by the other",
            RURAL,
            after(
                sway(passing, begin + 2.0, begin + 32.0, 3.4),
                beginning(RURAL, ":ridge_north_0_0"),
                6.0,
                9.0,
                (0.0, 14.0),
            ),
            brisk(
                drive=after(
                    turning,
                    beginning(RURAL, ":ridge_north_1_0"),
                    5.0,
                    9.0,
                    (0.0, 9.0),
                    (6.0, 9.0),
                    (8.0, 5.0),
                )
            ),
        ),
        placed(
            "vehicle-overtakes-ego-that-turns-left",
            "The ego turns left into a track; a vehicle from behind overtakes it there and hits "
            "its left side.",
            AT_FAULT,
            "Vienna art. 14/16 (make sure of those behind before turning)",
            RURAL,
            after(
                quarry,
                beginning(RURAL, ":quarry_1_0"),
                5.0,
                9.0,
                (0.0, 10.0),
                (5.0, 10.0),
                (8.0, 4.0),
            ),
            brisk(
                drive=after(
                    sway(beyond, start, start + 35.0, 3.4),
                    beginning(RURAL, ":quarry_0_0"),
                    3.5,
                    9.0,
                    (0.0, 16.0),
                )
            ),
        ),
        placed(
            "ego-passes-bicycle-too-near",
            "The ego passes a bicycle at a distance of half a metre and touches it as it comes "
            "back to its lane.",
            AT_FAULT,
            "nuPlan: active lateral collision; Vienna art. 11 (overtaking, sideways room, "
            "returning)",
            OLD_TOWN,
            meeting(
                sway(sway(wall, 95.0, 120.0, 1.1), 150.0, 170.0, -1.1),
                beside(OLD_TOWN, "wall_6_1", 160.0, 0.5),
                9.0,
                (0.0, 10.0),
            ),
            brisk(
                drive=meeting(
                    lanes(OLD_TOWN, "wall_6_1", left=-0.7),
                    beside(OLD_TOWN, "wall_6_1", 159.5, -0.7),
                    9.0,
                    (0.0, 5.0),
                ),
                model=BICYCLE,
            ),
        ),
        placed(
            "bus-pulls-out-before-ego",
            "A bus that creeps along the right edge pulls out as the ego comes up to it at 10 m/s.",
            NOT_AT_FAULT,
            "Vienna art. 14 (moving off / pulling out); UNECE R157 cut-in",
            TEE,
            meeting(stop, beside(TEE, "-harbour_2_0", 120.0, 0.0), 8.0, (0.0, 10.0)),
            brisk(
                drive=meeting(
                    sway(lanes(TEE, "-harbour_2_0", left=-3.4), 118.0, 138.0, 3.4),
                    beside(TEE, "-harbour_2_0", 129.0, -1.0),
                    8.0,
                    (0.0, 1.0),
                    (3.0, 1.0),
                    (6.0, 5.0),
                ),
                model=BUS,
            ),
        ),
    ]


def _standing_and_two_egos() -> list[Case]:
    pocket = lanes(ARTERIAL, "wb_east_pocket_2")
    beside_it = lanes(ARTERIAL, "wb_east_1", ":wb_school_pocket_0_1", "wb_east_pocket_1")
    zebra = lanes(GRID, "queen_2_1", ":c3_12_0", "queen_3_1")
    ramp_lane = lanes(HIGHWAY, "wb_a_decelerate_0")
    second = lanes(HIGHWAY, "wb_a_decelerate_1")
    along = lanes(HIGHWAY, "wb_1_0", ":wb_a_exit_0_0", "wb_a_decelerate_1")
    end = lanes(HIGHWAY, "eb_a_accelerate_0")
    stay = lanes(HIGHWAY, "eb_a_accelerate_1", ":eb_a_merged_0_0", "eb_3_0")
    drift = arc_of(beside_it, (1200.0, 4.25))
    return [
        placed(
            "ego-waits-in-pocket-and-vehicle-drifts-into-it",
            "The ego waits in the left-turn pocket; a vehicle that drives past drifts to the "
            "left and touches its right side.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; Vienna art. 14",
            ARTERIAL,
            Drive(way=pocket, speeds=((0.0, 10.0), (2.0, 10.0), (5.0, 0.0))),
            brisk(
                drive=meeting(
                    sway(beside_it, drift, drift + 30.0, 2.6), (1188.0, 5.3), 8.5, (0.0, 13.0)
                )
            ),
            to=(1141.0, 0.75),
        ),
        placed(
            "ego-has-stopped-with-its-front-on-zebra-and-is-hit",
            "The ego has stood at a red light for 3 s with its front on the zebra crossing; a "
            "vehicle behind brakes late and hits it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            GRID,
            meeting(zebra, (250.6, 218.38), 6.0, (0.0, 7.0), (3.0, 7.0), (5.0, 0.0)),
            brisk(drive=meeting(zebra, (245.9, 218.38), 8.2, (0.0, 9.0), (7.4, 9.0), (8.8, 3.0))),
            to=(300.0, 218.38),
        ),
        placed(
            "ego-stands-half-on-exit-lane-of-the-highway",
            "The ego has stopped across the line between the right lane and the exit lane of the "
            "highway; a vehicle at 27 m/s brakes late and hits its left rear.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            HIGHWAY,
            Drive(
                way=sway(second, 40.0, 110.0, -1.9), speeds=((0.0, 25.0), (2.0, 25.0), (6.5, 0.0))
            ),
            brisk(
                drive=meeting(
                    along,
                    beside(HIGHWAY, "wb_a_decelerate_1", 101.6, 0.0),
                    9.0,
                    (0.0, 27.0),
                    (8.0, 27.0),
                    (9.5, 15.0),
                )
            ),
            to=(float(ramp_lane[-1][0]), float(ramp_lane[-1][1])),
        ),
        Case(
            name="two-egos-meet-where-lane-ends",
            happens="One ego leaves the ending acceleration lane; the other, half a length "
            "behind in the next lane, speeds up, and their sides touch.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source=(
                "Vienna art. 14 (lane change), joining traffic gives way; RSS rule 2; UNECE "
                "R157 annex 3"
            ),
            town=HIGHWAY,
            egos=(
                Ego(
                    drive=steady(cut(sway(end, 210.0, 280.0, 3.75), 100.0), 20.0), to=(1293.0, 3.4)
                ),
                Ego(
                    drive=Drive(
                        way=cut(stay, 94.0), speeds=((0.0, 19.5), (4.0, 19.5), (8.0, 22.5))
                    ),
                    to=(1400.0, -4.4),
                    name="second",
                ),
            ),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_ends_of_lanes(), *_turning_round_and_overtaking(), *_standing_and_two_egos()]
