"""Cases in which the front of the ego meets the rear of a vehicle ahead, and a queue."""

from __future__ import annotations

from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case, Ego, Parked, Walker
from tests.oracles.responsibility.placing import (
    after,
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


def _ego_behind() -> list[Case]:
    red = lanes(ARTERIAL, "eb_farm_0", ":eb_school_pocket_0_0", "eb_farm_pocket_0", ":school_11_0")
    wall = lanes(OLD_TOWN, "wall_2_1")
    valley = lanes(RURAL, "-valley_8_0")
    lane = lanes(HIGHWAY, "eb_3_0", ":eb_b_exit_0_0", "eb_b_decelerate_1")
    entry = lanes(
        ROUND,
        "-northgate_0",
        ":great_north_0_0",
        "great_north_entry_0",
        ":great_north_in_0_0",
        "great_ring_4_0",
    )
    exit_road = lanes(
        ROUND,
        "great_ring_4_0",
        ":great_west_out_0_0",
        "great_west_exit_0",
        ":great_west_0_0",
        "west_1_0",
    )
    mill = lanes(OLD_TOWN, "-gate_street_1", ":well_4_0", "-east_street_1")
    over = lanes(HIGHWAY, "wb_5_2")
    return [
        placed(
            "leader-stops-at-red-and-ego-hits-it",
            "The vehicle 28 m ahead stops at a light that has turned red; the ego brakes late "
            "and hits it.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna art. 13",
            ARTERIAL,
            after(
                red,
                beginning(ARTERIAL, ":school_11_0"),
                -9.0,
                9.4,
                (0.0, 13.0),
                (8.4, 13.0),
                (10.0, 2.0),
            ),
            brisk(
                drive=after(
                    red, beginning(ARTERIAL, ":school_11_0"), -3.5, 9.0, *braking(5.4, 13.0, 4.0)
                )
            ),
            lights={"junctions": {"school": {"offset": -24.0}}},
        ),
        placed(
            "ego-hits-bicycle-off-centre",
            "The ego at 11 m/s catches a bicycle at 5 m/s at the right edge of the lane with its "
            "right front corner.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna art. 11 (sufficient lateral space)",
            OLD_TOWN,
            meeting(wall, beside(OLD_TOWN, "wall_2_1", 110.0, 0.0), 8.0, (0.0, 11.0)),
            brisk(
                drive=meeting(
                    lanes(OLD_TOWN, "wall_2_1", left=-0.9),
                    beside(OLD_TOWN, "wall_2_1", 113.4, -0.9),
                    8.0,
                    (0.0, 5.0),
                ),
                model=BICYCLE,
            ),
        ),
        placed(
            "ego-hits-truck-on-long-country-bend",
            "The ego at 22 m/s comes up to a truck at 12 m/s, brakes in the last second and hits "
            "it.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna 13",
            RURAL,
            meeting(
                valley,
                beside(RURAL, "-valley_8_0", 196.0, 0.0),
                8.0,
                (0.0, 22.0),
                (7.4, 22.0),
                (8.6, 14.0),
            ),
            brisk(
                drive=meeting(valley, beside(RURAL, "-valley_8_0", 202.0, 0.0), 8.0, (0.0, 12.0)),
                model=TRUCK,
            ),
        ),
        placed(
            "overtaker-comes-in-at-distance-and-brakes-two-seconds-later",
            "A vehicle at 27 m/s comes into the lane 8 m ahead of the ego at 25 m/s, brakes "
            "hard 2 s later, and the ego hits it.",
            AT_FAULT,
            "R157 annex 3 (avoidable from the intrusion); RSS rule 1; nuPlan active front "
            "collision",
            HIGHWAY,
            Drive(way=lane, speeds=((0.0, 25.0), (7.8, 25.0), (9.6, 14.0))),
            brisk(
                drive=Drive(
                    way=cut(
                        sway(
                            lanes(HIGHWAY, "eb_3_1", ":eb_b_exit_0_1", "eb_b_decelerate_2"),
                            60.0,
                            150.0,
                            -3.75,
                        ),
                        10.0,
                    ),
                    speeds=((0.0, 27.0), (6.6, 26.0), (8.6, 10.0)),
                )
            ),
        ),
        placed(
            "leader-starts-into-the-ring-and-stops-again",
            "At the entry of the roundabout the vehicle ahead starts and stops again after 3 m; "
            "the ego rolls into it at 3 m/s.",
            AT_FAULT,
            "nuPlan: active front collision / stopped track; RSS rule 1; Vienna art. 13",
            ROUND,
            after(
                entry,
                beginning(ROUND, ":great_north_in_0_0"),
                -6.5,
                8.0,
                (0.0, 7.0),
                (3.0, 7.0),
                (5.0, 1.0),
                (5.8, 1.0),
                (7.0, 3.0),
            ),
            brisk(
                drive=after(
                    entry,
                    beginning(ROUND, ":great_north_in_0_0"),
                    -0.5,
                    8.0,
                    (0.0, 6.0),
                    (2.0, 6.0),
                    (4.0, 0.6),
                    (5.0, 0.6),
                    (5.8, 3.0),
                    (6.8, 0.0),
                )
            ),
        ),
        placed(
            "leader-stops-in-exit-of-ring-for-walker",
            "A van stops in the exit of the roundabout for a pedestrian; the ego, 10 m behind, "
            "does not brake.",
            AT_FAULT,
            "RSS rule 1; nuPlan active front collision; Vienna 13",
            ROUND,
            Drive(way=exit_road, speeds=((0.0, 8.0),)),
            brisk(
                drive=Drive(way=cut(exit_road, 16.0), speeds=braking(2.5, 8.0, 4.0)), model=SPRINTER
            ),
            Walker(points=((-68.0, 12.5), (-68.0, 2.0)), start_time=1.0, name="walker"),
        ),
        placed(
            "ego-creeps-into-vehicle-before-town-junction",
            "The ego closes up to a waiting vehicle at 2.5 m/s and touches its rear.",
            AT_FAULT,
            "nuPlan: stopped track; RSS rule 1",
            OLD_TOWN,
            meeting(
                mill,
                beside(OLD_TOWN, "-gate_street_1", 100.0, 0.0),
                8.5,
                (0.0, 9.0),
                (4.0, 9.0),
                (6.0, 2.5),
            ),
            Parked(at=beside(OLD_TOWN, "-gate_street_1", 104.7, 0.0), yaw=192.0),
        ),
        placed(
            "ego-hits-ambulance-that-slows-in-left-lane",
            "In the left lane of the highway the ego at 28 m/s hits an ambulance, which has "
            "slowed down from 27 to 17 m/s over 3 s.",
            AT_FAULT,
            "nuPlan: active front collision; RSS rule 1; Vienna 13",
            HIGHWAY,
            Drive(way=over, speeds=((0.0, 28.0),)),
            brisk(
                drive=Drive(way=cut(over, 45.0), speeds=((0.0, 27.0), (2.0, 27.0), (5.0, 17.0))),
                model="vehicle.ford.ambulance",
            ),
        ),
    ]


def _chains() -> list[Case]:
    north = lanes(GRID, "bridge_1_1", ":c2_9_0", "bridge_2_1")
    return [
        Case(
            name="ego-in-the-middle-of-a-queue-is-hit-by-second",
            happens="The ego stops 1.5 m behind a standing vehicle; a second ego behind brakes "
            "too late and hits it.",
            expected=NOT_AT_FAULT,
            expected_of={"second": AT_FAULT},
            source="nuPlan: stopped ego, active rear collision; RSS rule 1",
            town=GRID,
            egos=(
                Ego(
                    drive=meeting(north, (269.88, 190.0), 8.0, *braking(5.0, 10.0, 4.0)),
                    to=(269.88, 209.0),
                ),
                Ego(
                    drive=meeting(
                        north, (269.88, 185.1), 8.0, (0.0, 10.0), (6.8, 10.0), (8.2, 3.0)
                    ),
                    to=(269.88, 209.0),
                    name="second",
                ),
            ),
            others=(Parked(at=(269.88, 196.4), yaw=90.0, name="front"),),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_ego_behind(), *_chains()]
