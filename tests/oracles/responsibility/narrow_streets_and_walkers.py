"""Further cases in narrow streets, with pedestrians and with objects on the road."""

from __future__ import annotations

from tests.oracles.responsibility.case import AT_FAULT, NOT_AT_FAULT, Case, Obstacle, Parked, Walker
from tests.oracles.responsibility.placing import (
    after,
    beginning,
    beside,
    brisk,
    heading,
    placed,
)
from tests.oracles.responsibility.ways import (
    Drive,
    lanes,
    meeting,
    straight,
    sway,
)

ARTERIAL, GRID, HIGHWAY = "arterial", "signal-grid", "highway"
OLD_TOWN, ROUND, RURAL, TEE = "old-town", "roundabout", "rural", "tee-town"
BICYCLE, BUS = "vehicle.gazelle.omafiets", "vehicle.mitsubishi.fusorosa"
SPRINTER, TRUCK = "vehicle.mercedes.sprinter", "vehicle.carlamotors.european_hgv"


def _narrow_streets() -> list[Case]:
    hill = lanes(OLD_TOWN, "castle_hill_1")
    down = lanes(OLD_TOWN, "-castle_hill_1")
    east = lanes(OLD_TOWN, "east_street_1")
    back = lanes(OLD_TOWN, "-east_street_1")
    lane = lanes(OLD_TOWN, "castle_lane_1")
    alley = lanes(OLD_TOWN, "bakers_1")
    gate = lanes(OLD_TOWN, "mill_gate_1")
    return [
        placed(
            "oncoming-swings-round-parked-vehicle-into-ego",
            "In a narrow street an oncoming vehicle goes round a parked one over the middle and "
            "meets the ego, which has its lane free.",
            NOT_AT_FAULT,
            "RSS rule 1 for opposite directions; Vienna art. 12",
            OLD_TOWN,
            meeting(hill, beside(OLD_TOWN, "castle_hill_1", 70.0, 0.0), 7.0, (0.0, 7.0)),
            brisk(
                drive=meeting(
                    sway(sway(down, 38.0, 50.0, 2.4), 72.0, 86.0, -2.4),
                    beside(OLD_TOWN, "castle_hill_1", 74.7, 1.0),
                    7.0,
                    (0.0, 7.0),
                )
            ),
            Parked(
                at=beside(OLD_TOWN, "-castle_hill_1", 60.0, -1.0),
                name="parked",
                yaw=heading(OLD_TOWN, "-castle_hill_1", 60.0),
            ),
        ),
        placed(
            "ego-swings-round-parked-vehicle-into-oncoming",
            "The ego goes round a vehicle parked on its side over the middle of the street, "
            "brakes, and meets an oncoming vehicle.",
            AT_FAULT,
            "Vienna 10, 11, 12(2); RSS rule 1 opposite directions",
            OLD_TOWN,
            meeting(
                sway(sway(east, 40.0, 52.0, 2.5), 74.0, 88.0, -2.5),
                beside(OLD_TOWN, "east_street_1", 64.0, 2.5),
                7.5,
                (0.0, 8.0),
                (6.6, 8.0),
                (8.0, 1.5),
            ),
            brisk(
                drive=meeting(back, beside(OLD_TOWN, "east_street_1", 68.7, 3.0), 7.5, (0.0, 8.0))
            ),
            Parked(
                at=beside(OLD_TOWN, "east_street_1", 62.0, -1.1),
                name="parked",
                yaw=heading(OLD_TOWN, "east_street_1", 62.0),
            ),
        ),
        placed(
            "ego-brushes-parked-vehicle-in-alley",
            "In a one-way alley the ego touches a vehicle that is parked partly in its lane, at "
            "walking pace.",
            AT_FAULT,
            "nuPlan: stopped track; Vienna art. 13",
            OLD_TOWN,
            meeting(
                lane,
                beside(OLD_TOWN, "castle_lane_1", 62.0, 0.0),
                8.0,
                (0.0, 5.0),
                (5.0, 5.0),
                (7.0, 1.8),
            ),
            Parked(
                at=beside(OLD_TOWN, "castle_lane_1", 67.0, -1.75),
                yaw=heading(OLD_TOWN, "castle_lane_1", 67.0),
            ),
        ),
        placed(
            "vehicle-comes-against-the-one-way-alley",
            "In a one-way alley a vehicle comes the wrong way; the ego brakes to 1 m/s and they "
            "meet head on.",
            NOT_AT_FAULT,
            "RSS rule 1 for opposite directions; Vienna art. 10",
            OLD_TOWN,
            meeting(
                alley,
                beside(OLD_TOWN, "bakers_1", 62.0, 0.0),
                8.0,
                (0.0, 5.5),
                (6.5, 5.5),
                (7.6, 1.0),
            ),
            brisk(
                drive=meeting(alley[::-1], beside(OLD_TOWN, "bakers_1", 66.7, 0.0), 8.0, (0.0, 5.0))
            ),
        ),
        placed(
            "ego-drives-against-the-one-way-street",
            "The ego drives the wrong way in a one-way street and meets a vehicle head on; both "
            "brake.",
            AT_FAULT,
            "Vienna art. 10 (direction of traffic); RSS rule 1 for opposite directions: the "
            "one in its correct lane is not to blame",
            OLD_TOWN,
            meeting(
                gate[::-1],
                beside(OLD_TOWN, "mill_gate_1", 52.0, 0.0),
                4.8,
                (0.0, 5.0),
                (4.0, 5.0),
                (5.2, 1.0),
            ),
            brisk(
                drive=meeting(
                    gate,
                    beside(OLD_TOWN, "mill_gate_1", 47.3, 0.0),
                    4.8,
                    (0.0, 5.5),
                    (4.0, 5.5),
                    (5.2, 1.0),
                )
            ),
            to=beside(OLD_TOWN, "wall_6_1", 200.0, 0.0),
        ),
    ]


def _walkers_and_objects() -> list[Case]:
    north = straight((280.0, 328.38), (391.0, 328.38))
    turn = lanes(GRID, "-corner_southeast_1", ":d1_2_0", "garden_1_1")
    valley = lanes(RURAL, "valley_1_0")
    mill = lanes(ARTERIAL, "eb_west_pocket_1", ":mill_5_1", "eb_mill_1")
    east = lanes(ARTERIAL, "wb_east_0")
    east_left = lanes(ARTERIAL, "wb_east_1")
    bend = lanes(RURAL, "valley_23_0", ":valley_limit_23_0_0", "valley_24_0")
    return [
        placed(
            "walker-comes-out-between-parked-vans",
            "A pedestrian runs out between two vans parked at the right edge 8 m ahead of the "
            "ego at 8 m/s.",
            NOT_AT_FAULT,
            "Vienna 20; R157 competent driver: not avoidable",
            GRID,
            meeting(north, (342.0, 328.38), 7.0, (0.0, 8.0), (6.5, 8.0), (7.5, 2.0)),
            Walker(points=((344.6, 325.2), (344.6, 332.0)), speed=2.6, start_time=6.0),
            Parked(at=(340.4, 325.6), name="van", model=SPRINTER),
            Parked(at=(348.8, 325.6), name="van_ahead", model=SPRINTER),
        ),
        placed(
            "ego-turns-right-over-crossing-with-walker",
            "The ego turns right at a junction without signals and hits a pedestrian half way "
            "over the crossing of the side road.",
            AT_FAULT,
            "Vienna art. 21 (pedestrians on the crossing of the road turned into)",
            GRID,
            meeting(turn, (401.62, 5.2), 8.0, (0.0, 8.0), (4.0, 8.0), (6.0, 4.0)),
            Walker(points=((396.2, 7.8), (405.0, 7.8)), start_time=4.3),
            to=(401.62, 60.0),
        ),
        placed(
            "ego-hits-walker-at-the-edge-of-country-road",
            "A pedestrian walks along the right edge of the road in the ego's direction; the ego "
            "at 16 m/s hits it with its right front corner.",
            AT_FAULT,
            "nuPlan: active front collision; Vienna art. 13, 21; RSS rule 1",
            RURAL,
            meeting(valley, beside(RURAL, "valley_1_0", 128.0, 0.0), 8.0, (0.0, 16.0)),
            Walker(
                points=(
                    beside(RURAL, "valley_1_0", 119.5, -0.95),
                    beside(RURAL, "valley_1_0", 140.0, -0.95),
                )
            ),
        ),
        placed(
            "walker-crosses-four-lanes-before-ego",
            "A pedestrian crosses the main road away from crossings, 4 s on the carriageway "
            "before the ego at 14 m/s hits it; the ego brakes late.",
            AT_FAULT,
            "RSS rule 3 (right of way is given, not taken); Vienna art. 13 and 21",
            ARTERIAL,
            meeting(mill, (308.0, -4.25), 7.0, (0.0, 14.0), (6.4, 14.0), (8.0, 6.0)),
            Walker(points=((310.8, -10.5), (310.8, 10.0)), start_time=2.8),
        ),
        placed(
            "obstacle-falls-and-ego-evades-into-vehicle",
            "A box falls 24 m ahead of the ego at 15 m/s; the ego evades to the left lane into a "
            "vehicle that drives beside it.",
            AT_FAULT,
            "nuPlan: active lateral collision while leaving its lane; Vienna art. 14; RSS rule "
            "5 (avoid an accident only without causing another)",
            ARTERIAL,
            Drive(way=sway(east, 58.0, 76.0, 3.0), speeds=((0.0, 15.0),)),
            brisk(drive=Drive(way=east_left, speeds=((0.0, 15.0),))),
            Obstacle(
                at=(1340.0 - 79.0, 7.75), name="box", start_time=3.5, model="static.prop.box01"
            ),
        ),
        placed(
            "ego-hits-hay-bale-after-bend",
            "A hay bale lies in the ego's lane after a bend; the ego at 17 m/s brakes half a "
            "second before it.",
            AT_FAULT,
            "nuPlan: stopped track; Vienna art. 13",
            RURAL,
            after(
                bend,
                beginning(RURAL, "valley_24_0"),
                27.0,
                8.0,
                (0.0, 17.0),
                (7.4, 17.0),
                (9.0, 6.0),
            ),
            Obstacle(at=beside(RURAL, "valley_24_0", 30.0, 0.0), model="static.prop.haybale"),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_narrow_streets(), *_walkers_and_objects()]
