"""Cases with what stands, walks, or is beside the road, and with two egos.

Queen Street of ``signal-grid``: lanes at y = 218.4 m (east) and 221.6 m (west), the southern
sidewalk at 215.8 m. Grand Street and its crossings: see the other families.
"""

from __future__ import annotations

from tests.oracles.responsibility.case import (
    AT_FAULT,
    NOT_AT_FAULT,
    UNDETERMINED,
    Car,
    Case,
    Ego,
    Obstacle,
    Other,
    Parked,
    Walker,
)
from tests.oracles.responsibility.ways import (
    Drive,
    braking,
    lanes,
    meeting,
    shift,
    steady,
    straight,
)

EAST, WEST, SIDEWALK = 218.38, 221.62, 215.75
MAIN_EAST = -1.62
"""Second Street, by the unsignalised junction d1 with a crossing at x = 392.2 m."""

STANDING = "nuPlan: stopped track; Vienna Convention art. 13.1 (stop within the range of vision)"
TOO_LATE = "UNECE R157 annex 3 (the driver cannot brake in time)"
PEDESTRIAN = "UNECE R157 5.2.5.3 and annex 3 (crossing pedestrian); Vienna Convention art. 21"
CROSSING = "Vienna Convention art. 21.2 (give way at pedestrian crossings)"


def _case(
    name: str,
    happens: str,
    expected: str,
    source: str,
    ego: Drive,
    *others: Other,
    end: tuple[float, float] = (529.0, EAST),
    seconds: float = 12.0,
) -> Case:
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town="signal-grid",
        egos=(Ego(drive=ego, to=end),),
        others=others,
        seconds=seconds,
    )


_EAST = straight((411.0, EAST), (530.0, EAST))


def _objects() -> list[Case]:
    off_road = straight((411.0, EAST), (430.0, EAST), (450.0, 214.0), (480.0, 213.0))
    return [
        _case(
            "ego-hits-obstacle-in-its-lane",
            "A container has stood in the ego's lane from the beginning.",
            AT_FAULT,
            STANDING,
            steady(_EAST, 8.0),
            Obstacle(at=(470.0, EAST)),
        ),
        _case(
            "ego-hits-wreck",
            "A wreck stands across the ego's lane.",
            AT_FAULT,
            STANDING,
            steady(_EAST, 8.0),
            Obstacle(at=(470.0, EAST), yaw=60.0, model="vehicle.toyota.prius"),
        ),
        _case(
            "ego-clips-vehicle-parked-half-in-its-lane",
            "A vehicle is parked half on the kerb; the ego does not go round it.",
            AT_FAULT,
            STANDING,
            steady(_EAST, 8.0),
            Parked(at=(470.0, EAST - 1.4)),
        ),
        _case(
            "obstacle-falls-before-ego",
            "An object appears 8 m ahead of the ego.",
            NOT_AT_FAULT,
            TOO_LATE + "; nuPlan would say stopped track",
            steady(_EAST, 10.0),
            Obstacle(at=(463.0, EAST), start_time=4.0, model="static.prop.trashcan01"),
        ),
        _case(
            "obstacle-falls-far-ahead",
            "An object appears 45 m ahead of the ego, which does not brake.",
            AT_FAULT,
            "UNECE R157 annex 3 (the driver can brake in time); nuPlan: stopped track",
            steady(_EAST, 10.0),
            Obstacle(at=(478.0, EAST), start_time=1.5, model="static.prop.trashcan01"),
        ),
        _case(
            "vehicle-appears-in-ego",
            "A vehicle appears where the ego is.",
            NOT_AT_FAULT,
            "no motion led there; UNECE R157 annex 3",
            steady(_EAST, 8.0),
            Parked(at=(444.0, EAST), start_time=4.0),
        ),
        _case(
            "ego-leaves-the-road-into-parked-vehicle",
            "The ego leaves the road and hits a vehicle that is parked there.",
            AT_FAULT,
            STANDING,
            steady(off_road, 8.0),
            Parked(at=(462.0, 213.6)),
        ),
        _case(
            "ego-leaves-the-road-into-fence",
            "The ego leaves the road and hits street furniture.",
            AT_FAULT,
            STANDING,
            steady(off_road, 8.0),
            Obstacle(at=(460.0, 213.6), model="static.prop.vendingmachine"),
        ),
        _case(
            "ego-off-the-road-is-driven-into",
            "The ego leaves the road; a vehicle that drives beside the road runs into its side.",
            UNDETERMINED,
            "nuPlan blames an ego off the drivable area; the other had no business there either",
            steady(straight((411.0, EAST), (430.0, EAST), (444.0, 213.0), (520.0, 213.0)), 6.0),
            Car(
                drive=meeting(
                    straight((400.0, 206.0), (450.0, 206.0), (480.0, 216.0)),
                    (466.0, 211.3),
                    9.2,
                    (0.0, 6.5),
                )
            ),
        ),
        _case(
            "vehicle-from-the-verge-hits-ego",
            "A vehicle comes from beside the road into the ego's right side.",
            NOT_AT_FAULT,
            "Vienna Convention art. 12.3 (from a property on to the road); nuPlan: active lateral",
            steady(_EAST, 8.0),
            Car(
                drive=meeting(
                    straight((455.0, 192.0), (468.0, 212.0), (472.0, 219.0)),
                    (470.0, 215.5),
                    7.4,
                    (0.0, 6.0),
                )
            ),
        ),
        _case(
            "ego-hits-vehicle-that-dashes-from-the-verge",
            "A vehicle comes from beside the road, straight across, a moment before the ego.",
            NOT_AT_FAULT,
            "Vienna Convention art. 12.3; " + TOO_LATE,
            steady(_EAST, 10.0),
            Car(
                drive=meeting(
                    straight((470.0, 192.0), (470.0, 232.0)), (470.0, 217.5), 5.7, (0.0, 7.0)
                )
            ),
        ),
        _case(
            "parked-ego-is-hit",
            "The ego stands at the kerb, half on the sidewalk, and is hit from behind.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego",
            Drive(
                way=shift(411.0, EAST, 420.0, 436.0, EAST - 1.0, 530.0),
                speeds=braking(3.0, 8.0, 4.0),
            ),
            Car(drive=meeting(_EAST, (443.0, EAST), 8.5, (0.0, 7.0))),
        ),
    ]


def _walkers() -> list[Case]:
    main = straight((340.0, MAIN_EAST), (391.0, MAIN_EAST), (410.0, MAIN_EAST))
    to_main = (410.0, -1.6)
    return [
        _case(
            "walker-on-crossing",
            "A pedestrian walks over a crossing without signals; the ego does not give way.",
            AT_FAULT,
            CROSSING,
            steady(main, 8.0),
            Walker(points=((392.2, 5.0), (392.2, -5.0)), start_time=1.7),
            end=to_main,
        ),
        _case(
            "walker-stands-on-crossing",
            "A pedestrian has stopped on the crossing in front of the ego.",
            AT_FAULT,
            CROSSING,
            steady(main, 8.0),
            Walker(points=((392.2, 4.0), (392.2, -1.6)), speed=2.5),
            end=to_main,
        ),
        _case(
            "walker-runs-onto-crossing",
            "A pedestrian runs on to the crossing when the ego is 5 m from it.",
            UNDETERMINED,
            "Vienna Convention art. 21.2 asks the ego to give way, art. 20.6 the pedestrian to "
            "look; " + TOO_LATE,
            steady(main, 8.0),
            Walker(points=((392.2, -4.6), (392.2, 4.0)), speed=4.0, start_time=5.55),
            end=to_main,
        ),
        _case(
            "walker-steps-out",
            "A pedestrian steps from the sidewalk into the road 0.6 s before the ego.",
            NOT_AT_FAULT,
            PEDESTRIAN + ": too late to brake",
            steady(_EAST, 10.0),
            Walker(points=((470.0, 215.6), (470.0, 222.0)), speed=2.5, start_time=4.8),
        ),
        _case(
            "walker-crosses-in-good-time",
            "A pedestrian crosses away from crossings, in the road for 3 s before the ego comes.",
            AT_FAULT,
            PEDESTRIAN + ": the driver can brake in time",
            steady(_EAST, 8.0),
            Walker(points=((470.0, 226.0), (470.0, 212.0)), speed=1.2, start_time=1.3),
        ),
        _case(
            "walker-walks-into-egos-side",
            "A pedestrian walks into the side of the passing ego.",
            NOT_AT_FAULT,
            "nuPlan: active lateral collision, the ego in its lane; Vienna Convention art. 20.6",
            steady(_EAST, 5.0),
            Walker(points=((470.0, 214.5), (470.0, 222.0)), speed=1.4, start_time=9.75),
            seconds=15.0,
        ),
        _case(
            "walker-on-sidewalk-hit-by-ego",
            "The ego drives over the sidewalk and hits a pedestrian there.",
            AT_FAULT,
            "Vienna Convention art. 10.1 (vehicles keep to the carriageway)",
            steady(
                straight((411.0, EAST), (440.0, EAST), (456.0, SIDEWALK), (530.0, SIDEWALK)), 7.0
            ),
            Walker(points=((490.0, SIDEWALK), (470.0, SIDEWALK))),
        ),
        _case(
            "walker-walks-into-standing-ego",
            "A pedestrian walks into the ego, which has stopped for it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego",
            Drive(way=_EAST, speeds=braking(3.0, 8.0, 4.0)),
            Walker(points=((445.0, 214.0), (445.0, 224.0)), start_time=5.5),
        ),
        _case(
            "walker-along-the-lane",
            "A pedestrian walks along the ego's lane and is hit from behind.",
            AT_FAULT,
            "UNECE R157 annex 3 (the driver can brake in time); nuPlan: active front",
            steady(_EAST, 8.0),
            Walker(points=((450.0, EAST), (500.0, EAST))),
        ),
        _case(
            "walker-stands-in-the-lane",
            "A pedestrian has stood in the ego's lane from the beginning.",
            AT_FAULT,
            STANDING,
            steady(_EAST, 8.0),
            Walker(points=((470.0, EAST),)),
        ),
        _case(
            "walker-hit-in-the-oncoming-lane",
            "The ego drives in the oncoming lane and hits a pedestrian who has just stepped in.",
            AT_FAULT,
            "Vienna Convention art. 10.1: the ego had no right to be there",
            steady(shift(411.0, EAST, 425.0, 440.0, WEST, 530.0), 9.0),
            Walker(points=((475.0, 225.2), (475.0, 216.0)), speed=2.5, start_time=5.75),
        ),
    ]


def _signalised_crossings() -> list[Case]:
    """Junction d2: the crossing at x = 392.8 m has red while Grand Street has green, until 25 s;
    that of its southern arm, at y = 99 m, has green until 20 s."""
    street = straight((320.0, 105.12), (430.0, 105.12))
    turn = lanes("signal-grid", "grand_3_1", ":d2_10_0", ":d2_20_0", "-garden_1_1")
    return [
        _case(
            "walker-on-red-late",
            "A pedestrian runs over a signalised crossing on red, right before the ego on green.",
            NOT_AT_FAULT,
            "Vienna Convention art. 20.6 (pedestrians and their signals); " + TOO_LATE,
            steady(street, 10.0),
            Walker(points=((392.8, 101.5), (392.8, 112.0)), speed=3.0, start_time=6.0),
            end=(430.0, 105.1),
        ),
        _case(
            "walker-on-green-hit-by-turning-ego",
            "The ego turns right on green and hits a pedestrian who crosses on green.",
            AT_FAULT,
            "Vienna Convention art. 16.2 (turning: give way to pedestrians); art. 21.2",
            meeting(turn, (398.4, 99.0), 7.0, (0.0, 6.0)),
            Walker(points=((404.5, 99.0), (394.0, 99.0)), start_time=2.3),
            end=(398.4, 60.0),
        ),
    ]


def _two_egos() -> list[Case]:
    right, left = 105.12, 108.38
    return [
        Case(
            name="ego-cuts-in-before-another-ego",
            happens="One ego changes lanes a few metres ahead of another, faster one.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source="UNECE R157 5.2.5.2 (cut-in); RSS rule 2; judged for each ego",
            town="signal-grid",
            egos=(
                Ego(
                    drive=steady(shift(429.0, left, 441.0, 453.0, right, 530.0), 7.0),
                    to=(529.0, right),
                ),
                Ego(
                    drive=steady(straight((411.0, right), (530.0, right)), 13.0),
                    to=(529.0, right),
                    name="second",
                ),
            ),
        ),
        Case(
            name="ego-on-the-wrong-side-meets-another-ego",
            happens="One ego drives in the oncoming lane, where another comes.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source="RSS rule 1 for opposite directions; judged for each ego",
            town="signal-grid",
            egos=(
                Ego(
                    drive=steady(shift(411.0, EAST, 420.0, 440.0, WEST, 530.0), 9.0),
                    to=(529.0, EAST),
                ),
                Ego(
                    drive=steady(straight((529.0, WEST), (410.0, WEST)), 8.0),
                    to=(411.0, WEST),
                    name="second",
                ),
            ),
        ),
        Case(
            name="ego-runs-into-another-ego",
            happens="One ego runs into another that brakes ahead of it.",
            expected=AT_FAULT,
            expected_of={"second": NOT_AT_FAULT},
            source="RSS rule 1; judged for each ego",
            town="signal-grid",
            egos=(
                Ego(drive=steady(_EAST, 8.0), to=(529.0, EAST)),
                Ego(
                    drive=Drive(
                        way=straight((430.0, EAST), (530.0, EAST)), speeds=braking(2.0, 8.0, 6.0)
                    ),
                    to=(529.0, EAST),
                    name="second",
                ),
            ),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_objects(), *_walkers(), *_signalised_crossings(), *_two_egos()]
