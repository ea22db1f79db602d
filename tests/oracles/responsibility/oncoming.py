"""Cases between vehicles of opposite directions, on Queen Street of ``signal-grid``.

One lane to the east (y = 218.4 m) and one to the west (y = 221.6 m), from x = 409 m to 531 m.
"""

from __future__ import annotations

from drivora_service.geometry.array_shapes import FloatArray
from tests.oracles.responsibility.case import (
    AT_FAULT,
    NOT_AT_FAULT,
    UNDETERMINED,
    Car,
    Case,
    Ego,
    Other,
    Parked,
)
from tests.oracles.responsibility.ways import (
    Drive,
    braking,
    detour,
    meeting,
    shift,
    steady,
    straight,
)

EAST, WEST = 218.38, 221.62

ONCOMING = (
    "RSS rule 1 for opposite directions (the correct direction is that of the lane); "
    "Vienna Convention art. 10.1 and 13.5"
)
STANDS = (
    "Vienna Convention art. 11.8 (no overtaking into oncoming traffic) and 23.1 (standing on "
    "the side of the direction of travel)"
)


def _case(
    name: str,
    happens: str,
    expected: str,
    source: str,
    ego: Drive,
    *others: Other,
    seconds: float = 12.0,
) -> Case:
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town="signal-grid",
        egos=(Ego(drive=ego, to=(529.0, EAST)),),
        others=others,
        seconds=seconds,
    )


def _east(y: float = EAST, x: float = 411.0) -> FloatArray:
    return straight((x, y), (530.0, y))


def _west(y: float = WEST, x: float = 530.0) -> FloatArray:
    return straight((x, y), (410.0, y))


def _over(begin: float, end: float, y: float, x: float = 411.0) -> FloatArray:
    return shift(x, EAST, begin, end, y, 530.0)


def _other_over(begin: float, end: float, y: float, x: float = 530.0) -> FloatArray:
    return shift(x, WEST, begin, end, y, 410.0)


def _moving() -> list[Case]:
    return [
        _case(
            "head-on-with-wrong-way-driver",
            "A vehicle drives the wrong way in the ego's lane, straight at it.",
            NOT_AT_FAULT,
            ONCOMING,
            steady(_east(), 8.0),
            Car(drive=steady(_west(EAST), 8.0)),
        ),
        _case(
            "head-on-with-driver-who-comes-over",
            "An oncoming vehicle leaves its lane a second before it would pass the ego.",
            NOT_AT_FAULT,
            ONCOMING,
            steady(_east(), 10.0),
            Car(drive=meeting(_other_over(480.0, 468.0, EAST), (465.0, EAST), 5.0, (0.0, 10.0))),
        ),
        _case(
            "head-on-with-slow-wrong-way-driver",
            "The wrong-way driver creeps at 1.5 m/s towards the ego.",
            NOT_AT_FAULT,
            ONCOMING,
            steady(_east(), 8.0),
            Car(drive=steady(_west(EAST, 470.0), 1.5)),
        ),
        _case(
            "ego-head-on-in-oncoming-lane",
            "The ego drives in the oncoming lane and meets a vehicle there.",
            AT_FAULT,
            ONCOMING,
            steady(_over(420.0, 440.0, WEST), 9.0),
            Car(drive=steady(_west(), 8.0)),
        ),
        _case(
            "ego-head-on-while-overtaking",
            "The ego overtakes a slow vehicle and meets an oncoming one.",
            AT_FAULT,
            "Vienna Convention art. 11.2 (overtaking only if the lane ahead is free); RSS rule 1",
            steady(_over(420.0, 440.0, WEST), 10.0),
            Car(drive=steady(_east(EAST, 440.0), 3.0), name="slow"),
            Car(drive=steady(_west(), 8.0)),
        ),
        _case(
            "oncoming-overtaker-meets-ego",
            "An oncoming vehicle overtakes another and meets the ego head on.",
            NOT_AT_FAULT,
            "Vienna Convention art. 11.2; RSS rule 1 for opposite directions",
            steady(_east(), 8.0),
            Car(drive=steady(_west(WEST, 480.0), 3.0), name="slow"),
            Car(drive=steady(_other_over(515.0, 495.0, EAST), 10.0)),
        ),
        _case(
            "oncoming-vehicle-reaches-over-the-line",
            "An oncoming vehicle drives a metre over the line and touches the ego's left side.",
            NOT_AT_FAULT,
            ONCOMING,
            steady(_east(), 8.0),
            Car(drive=steady(_west(WEST - 1.6), 8.0)),
        ),
        _case(
            "ego-reaches-over-the-line",
            "The ego drives a metre over the line and touches an oncoming vehicle.",
            AT_FAULT,
            ONCOMING,
            steady(_over(420.0, 435.0, EAST + 1.6), 8.0),
            Car(drive=steady(_west(), 8.0)),
        ),
        _case(
            "both-reach-over-the-line",
            "The ego and an oncoming vehicle both drive in the middle of the road.",
            UNDETERMINED,
            "RSS for opposite directions needs one that keeps its lane",
            steady(_over(420.0, 435.0, EAST + 1.2), 8.0),
            Car(drive=steady(_west(WEST - 1.2), 8.0)),
        ),
        _case(
            "ego-cuts-the-corner-of-its-swerve",
            "The ego swerves over the line round a vehicle at the kerb into an oncoming one.",
            AT_FAULT,
            "Vienna Convention art. 11.2 and 12.2 (who is obstructed gives way)",
            steady(shift(411.0, EAST, 440.0, 452.0, EAST + 1.7, 530.0), 8.0),
            Parked(at=(470.0, EAST - 1.3), name="parked"),
            Car(drive=meeting(_west(), (468.0, WEST), 6.8, (0.0, 8.0))),
        ),
        _case(
            "ego-evades-wrong-way-driver-who-returns",
            "A wrong-way driver goes back to its lane just as the ego evades into that lane.",
            UNDETERMINED,
            "both left their lanes, the ego because of the other: no rule of the sources decides",
            steady(_over(452.0, 462.0, WEST), 8.0),
            Car(
                drive=meeting(
                    shift(530.0, EAST, 488.0, 476.0, WEST, 410.0), (468.0, WEST), 7.2, (0.0, 8.0)
                )
            ),
        ),
        _case(
            "wrong-way-driver-swerves-into-egos-side",
            "A vehicle on the wrong side comes over from the verge into the ego's right side.",
            NOT_AT_FAULT,
            ONCOMING,
            steady(_east(EAST + 0.3), 8.0),
            Car(
                drive=meeting(
                    shift(530.0, EAST - 3.0, 478.0, 460.0, EAST + 0.5, 410.0),
                    (470.0, EAST - 2.0),
                    7.2,
                    (0.0, 8.0),
                )
            ),
        ),
        _case(
            "wrong-way-ego-hit-from-behind-by-another",
            "Two drive in the oncoming lane one behind the other; the second runs into the ego.",
            NOT_AT_FAULT,
            "RSS rule 1: the one behind keeps the distance, whatever the lane",
            steady(_over(430.0, 440.0, WEST, 426.0), 6.0),
            Car(drive=steady(shift(411.0, EAST, 418.0, 430.0, WEST, 530.0), 11.0)),
        ),
        _case(
            "ego-returns-into-vehicle-that-it-overtakes",
            "The ego comes back to its lane before it has passed the slower vehicle.",
            AT_FAULT,
            "Vienna Convention art. 11.4; nuPlan: active lateral collision",
            steady(detour(411.0, EAST, (416.0, 436.0), WEST, (456.0, 476.0), 530.0), 11.0),
            Car(drive=steady(_east(EAST, 436.0), 6.5)),
        ),
        _case(
            "overtaker-returns-into-ego",
            "A vehicle that overtakes the ego comes back before it has passed.",
            NOT_AT_FAULT,
            "Vienna Convention art. 11.4; nuPlan: active lateral collision",
            steady(_east(EAST, 436.0), 6.5),
            Car(
                drive=steady(detour(411.0, EAST, (416.0, 436.0), WEST, (456.0, 476.0), 530.0), 11.0)
            ),
        ),
        _case(
            "other-turns-round-before-ego",
            "An oncoming vehicle turns round across the ego's lane, a few metres ahead.",
            NOT_AT_FAULT,
            "Vienna Convention art. 14.2 (turning round without endangering others); UNECE R157 "
            "annex 3 (too late to brake)",
            steady(_east(), 10.0),
            Car(
                drive=meeting(
                    straight(
                        (530.0, WEST), (478.0, WEST), (474.0, 220.8), (472.5, EAST), (473.0, 216.0)
                    ),
                    (472.5, EAST),
                    5.8,
                    (0.0, 5.0),
                )
            ),
        ),
        _case(
            "ego-turns-round-before-oncoming-vehicle",
            "The ego turns across the oncoming lane and is hit by a vehicle there.",
            AT_FAULT,
            "Vienna Convention art. 14.2",
            steady(
                straight(
                    (411.0, EAST), (460.0, EAST), (464.0, 219.5), (466.0, WEST), (466.0, 226.0)
                ),
                5.0,
            ),
            Car(drive=meeting(_west(), (466.0, WEST), 11.0, (0.0, 5.5))),
        ),
    ]


def _standing() -> list[Case]:
    there = straight((411.0, EAST), (425.0, EAST), (438.0, WEST), (530.0, WEST))
    return [
        _case(
            "ego-stops-in-oncoming-lane",
            "The ego goes into the oncoming lane, stops there, and is hit a second later.",
            AT_FAULT,
            STANDS,
            Drive(way=there, speeds=braking(3.6, 8.0, 5.0)),
            Car(drive=meeting(_west(), (446.0, WEST), 6.6, (0.0, 8.0))),
        ),
        _case(
            "ego-has-stood-in-oncoming-lane",
            "The ego has stood in the oncoming lane for seconds when it is hit.",
            AT_FAULT,
            STANDS,
            Drive(way=there, speeds=braking(3.6, 8.0, 5.0)),
            Car(drive=meeting(_west(), (446.0, WEST), 10.5, (0.0, 7.0))),
            seconds=14.0,
        ),
        _case(
            "ego-stands-half-in-oncoming-lane",
            "The ego stands across the middle line and is hit by an oncoming vehicle.",
            AT_FAULT,
            STANDS,
            Drive(
                way=straight(
                    (411.0, EAST), (425.0, EAST), (436.0, EAST + 1.6), (530.0, EAST + 1.6)
                ),
                speeds=braking(3.6, 8.0, 5.0),
            ),
            Car(drive=meeting(_west(), (446.0, WEST), 7.0, (0.0, 7.0))),
        ),
        _case(
            "ego-stands-in-its-lane-head-on",
            "An oncoming vehicle comes over and hits the ego, which stands in its own lane.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1 for opposite directions",
            Drive(way=_east(), speeds=braking(3.0, 8.0, 5.0)),
            Car(drive=meeting(_other_over(465.0, 450.0, EAST), (444.0, EAST), 7.5, (0.0, 8.0))),
        ),
        _case(
            "ego-stands-in-its-lane-and-is-brushed",
            "An oncoming vehicle over the line touches the ego, which stands in its own lane.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; Vienna Convention art. 13.5",
            Drive(way=_east(), speeds=braking(3.0, 8.0, 5.0)),
            Car(drive=meeting(_west(WEST - 1.7), (444.0, WEST), 7.5, (0.0, 8.0))),
        ),
        _case(
            "ego-runs-into-vehicle-that-stands-the-wrong-way",
            "A vehicle has stood in the ego's lane from the beginning, facing it.",
            AT_FAULT,
            "nuPlan: stopped track; Vienna Convention art. 13.1",
            steady(_east(), 8.0),
            Parked(at=(470.0, EAST), yaw=180.0),
        ),
        _case(
            "ego-hits-vehicle-that-stands-in-oncoming-lane",
            "The ego drives in the oncoming lane into a vehicle that waits there.",
            AT_FAULT,
            "nuPlan: stopped track; Vienna Convention art. 10.1",
            steady(_over(425.0, 438.0, WEST), 8.0),
            Parked(at=(470.0, WEST), yaw=180.0),
        ),
        _case(
            "wrong-way-driver-stops-short-before-ego",
            "An oncoming vehicle comes over and stops in the ego's lane a moment before the ego.",
            NOT_AT_FAULT,
            "UNECE R157 annex 3 (too late to brake); nuPlan would say stopped track",
            steady(_east(), 11.0),
            Car(
                drive=Drive(
                    way=shift(490.0, WEST, 478.0, 470.0, EAST, 410.0),
                    speeds=((0.0, 4.0), (3.7, 4.0), (4.95, 0.0)),
                )
            ),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_moving(), *_standing()]
