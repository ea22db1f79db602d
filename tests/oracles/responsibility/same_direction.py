"""Cases on a road between vehicles of one direction: following, cutting in, changing lanes.

Grand Street of ``signal-grid`` has two lanes to the east (y = 105.1 and 108.4 m), from x = 409 m to
531 m, and two to the west; Queen Street one each way.
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
    cut,
    lanes,
    meeting,
    shift,
    steady,
    straight,
    sway,
)

RIGHT, LEFT = 105.12, 108.38
END = 529.0
HIGHWAY_END = (310.0, -10.4)

FOLLOWING = (
    "nuPlan: active front collision; RSS rule 1 (safe distance to the vehicle ahead); "
    "Vienna Convention art. 13.5"
)
REAR = "nuPlan: active rear collision; RSS rule 1 (the one behind keeps the distance)"
CUT_IN = "UNECE R157 5.2.5.2 and annex 3 (cut-in); RSS rule 2 (do not cut in recklessly)"
LATE_BRAKING = "UNECE R157 annex 3 (the driver can brake in time); RSS rule 1"
LANE = "nuPlan: active lateral collision; Vienna Convention art. 11.2 and 14.1 (changing lanes)"


def _case(
    name: str,
    happens: str,
    expected: str,
    source: str,
    ego: Drive,
    *others: Other,
    end: tuple[float, float] = (END, RIGHT),
    town: str = "signal-grid",
    seconds: float = 12.0,
) -> Case:
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town=town,
        egos=(Ego(drive=ego, to=end),),
        others=others,
        seconds=seconds,
    )


def _along(y: float, x: float = 411.0) -> FloatArray:
    return straight((x, y), (530.0, y))


def _change(y0: float, begin: float, end: float, y1: float, x: float = 411.0) -> FloatArray:
    return shift(x, y0, begin, end, y1, 530.0)


def _following() -> list[Case]:
    right = _along(RIGHT)
    return [
        _case(
            "ego-runs-into-braking-leader",
            "The vehicle ahead brakes to a stop; the ego does not.",
            AT_FAULT,
            FOLLOWING,
            steady(right, 10.0),
            Car(drive=Drive(way=_along(RIGHT, 435.0), speeds=braking(1.0, 10.0, 3.0))),
        ),
        _case(
            "ego-runs-into-slower-leader",
            "The ego at 12 m/s comes up to a vehicle at 5 m/s and does not brake.",
            AT_FAULT,
            FOLLOWING,
            steady(right, 12.0),
            Car(drive=steady(_along(RIGHT, 445.0), 5.0)),
        ),
        _case(
            "ego-runs-into-standing-queue",
            "The ego drives into a vehicle that has stood in its lane from the beginning.",
            AT_FAULT,
            "nuPlan: stopped track; Vienna Convention art. 13.1 (stop within the range of vision)",
            steady(right, 10.0),
            Parked(at=(470.0, RIGHT)),
        ),
        _case(
            "ego-runs-into-leader-at-the-left-of-its-lane",
            "As behind any slower vehicle; this one drives 0.7 m left of the middle of the lane.",
            AT_FAULT,
            FOLLOWING,
            steady(right, 12.0),
            Car(drive=steady(_along(RIGHT + 0.7, 445.0), 5.0)),
        ),
        _case(
            "ego-hit-from-behind-while-cruising",
            "A faster vehicle runs into the ego from behind.",
            NOT_AT_FAULT,
            REAR,
            steady(_along(RIGHT, 440.0), 7.0),
            Car(drive=steady(_along(RIGHT, 412.0), 13.0)),
        ),
        _case(
            "ego-hit-from-behind-while-braking",
            "The ego brakes hard without a reason; the vehicle 14 m behind does not.",
            NOT_AT_FAULT,
            REAR + ": the distance must do for the hardest braking ahead",
            Drive(way=_along(RIGHT, 432.0), speeds=braking(2.0, 10.0, 7.0)),
            Car(drive=steady(_along(RIGHT, 414.0), 10.0)),
        ),
        _case(
            "ego-hit-from-behind-while-waiting",
            "The ego has stood in its lane for seconds when it is hit from behind.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            Drive(way=_along(RIGHT, 455.0), speeds=braking(0.5, 6.0, 4.0)),
            Car(drive=meeting(right, (466.0, RIGHT), 6.5, (0.0, 8.0))),
        ),
        _case(
            "ego-hit-from-behind-off-centre",
            "A faster vehicle in the right half of the lane catches the ego's right rear corner.",
            NOT_AT_FAULT,
            REAR,
            steady(_along(RIGHT, 440.0), 6.0),
            Car(drive=steady(_along(RIGHT - 0.6, 412.0), 12.0)),
        ),
        _case(
            "ego-runs-into-leader-on-the-highway",
            "At 30 m/s into a vehicle at 22 m/s in the same lane.",
            AT_FAULT,
            FOLLOWING,
            steady(lanes("highway", "eb_1_1"), 30.0),
            Car(drive=steady(cut(lanes("highway", "eb_1_1"), 40.0), 22.0)),
            town="highway",
            end=HIGHWAY_END,
        ),
        _case(
            "ego-creeps-into-standing-leader",
            "The ego rolls at 1.5 m/s into a vehicle that waits in front of it.",
            AT_FAULT,
            "nuPlan: stopped track",
            steady(_along(RIGHT, 450.0), 1.5),
            Parked(at=(460.0, RIGHT)),
        ),
        _case(
            "other-creeps-into-standing-ego",
            "A vehicle behind rolls at 1.5 m/s into the ego, which waits.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego",
            Drive(way=_along(RIGHT, 455.0), speeds=braking(0.5, 4.0, 4.0)),
            Car(drive=meeting(_along(RIGHT, 440.0), (454.0, RIGHT), 5.0, (0.0, 1.5))),
        ),
    ]


def _others_cut_in() -> list[Case]:
    right = _along(RIGHT)
    return [
        _case(
            "other-cuts-in-short",
            "A slower vehicle changes into the ego's lane a few metres ahead of it.",
            NOT_AT_FAULT,
            CUT_IN,
            steady(right, 13.0),
            Car(drive=steady(_change(LEFT, 441.0, 454.0, RIGHT, 433.0), 7.0)),
        ),
        _case(
            "other-cuts-in-short-from-the-right",
            "As before, from the right into the left lane.",
            NOT_AT_FAULT,
            CUT_IN,
            steady(_along(LEFT), 13.0),
            Car(drive=steady(_change(RIGHT, 441.0, 454.0, LEFT, 433.0), 7.0)),
            end=(END, LEFT),
        ),
        _case(
            "other-cuts-in-far-ahead",
            "A slower vehicle is in the ego's lane 4 s before the ego, unbraked, reaches it.",
            AT_FAULT,
            LATE_BRAKING,
            steady(right, 13.0),
            Car(drive=steady(_change(LEFT, 455.0, 465.0, RIGHT, 449.0), 5.0)),
        ),
        _case(
            "other-cuts-in-and-brakes",
            "A vehicle of the ego's speed changes in a metre ahead and brakes hard at once.",
            NOT_AT_FAULT,
            CUT_IN,
            steady(right, 11.0),
            Car(
                drive=Drive(
                    way=_change(LEFT, 419.0, 443.0, RIGHT, 417.0), speeds=braking(1.0, 11.0, 3.2)
                )
            ),
        ),
        _case(
            "other-cuts-in-and-brakes-later",
            "A vehicle changes in ahead at the ego's speed; 6 s later it brakes, the ego does not.",
            AT_FAULT,
            "RSS rule 1: within the response time the ego has to open the distance again",
            steady(right, 8.0),
            Car(
                drive=Drive(
                    way=_change(LEFT, 424.0, 444.0, RIGHT, 422.0), speeds=braking(8.0, 8.0, 3.2)
                )
            ),
            seconds=16.0,
        ),
        _case(
            "other-swipes-ego-while-changing-lanes",
            "A vehicle beside the ego changes into its lane and touches its side.",
            NOT_AT_FAULT,
            LANE,
            steady(_along(RIGHT, 420.0), 10.0),
            Car(drive=steady(_change(LEFT, 440.0, 465.0, RIGHT, 421.0), 10.0)),
        ),
        _case(
            "other-drifts-into-ego",
            "A vehicle beside the ego drifts slowly over the line.",
            NOT_AT_FAULT,
            LANE,
            steady(_along(RIGHT + 0.2, 420.0), 10.0),
            Car(drive=steady(_change(LEFT, 430.0, 490.0, LEFT - 1.6, 420.0), 10.0)),
        ),
        _case(
            "other-swipes-standing-ego",
            "A vehicle changes lanes into the side of the ego, which waits in its lane.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; Vienna Convention art. 14.1",
            Drive(way=_along(RIGHT, 455.0), speeds=braking(0.5, 6.0, 4.0)),
            Car(drive=steady(_change(LEFT, 447.0, 470.0, RIGHT, 415.0), 8.0)),
        ),
        _case(
            "parked-vehicle-pulls-out-short",
            "A vehicle pulls out from the kerb a few metres in front of the ego.",
            NOT_AT_FAULT,
            "Vienna Convention art. 14.1 and 14.3; UNECE R157 5.2.5.2 (cut-in)",
            steady(right, 11.0),
            Car(drive=steady(_change(RIGHT - 3.3, 452.0, 464.0, RIGHT, 443.0), 4.0)),
        ),
        _case(
            "parked-vehicle-pulls-out-far-ahead",
            "A vehicle pulls out from the kerb in good time; the ego does not slow down.",
            AT_FAULT,
            LATE_BRAKING,
            steady(right, 11.0),
            Car(drive=steady(_change(RIGHT - 3.3, 458.0, 468.0, RIGHT, 456.0), 4.0)),
        ),
        _case(
            "other-overtakes-and-swings-back-into-ego",
            "On the highway a faster vehicle comes back before it has passed the ego.",
            NOT_AT_FAULT,
            LANE,
            steady(lanes("highway", "eb_1_0"), 22.0),
            Car(drive=steady(sway(lanes("highway", "eb_1_1"), 70.0, 135.0, -3.75), 22.8)),
            town="highway",
            end=HIGHWAY_END,
        ),
        _case(
            "other-cuts-in-on-the-highway-with-headway",
            "A vehicle at 20 m/s comes into the lane 60 m ahead of the ego at 30 m/s.",
            AT_FAULT,
            LATE_BRAKING,
            steady(lanes("highway", "eb_1_0"), 30.0),
            Car(
                drive=steady(cut(sway(lanes("highway", "eb_1_1"), 70.0, 125.0, -3.75), 68.0), 20.0)
            ),
            town="highway",
            end=HIGHWAY_END,
        ),
    ]


def _ego_cuts_in() -> list[Case]:
    left = _along(LEFT)
    return [
        _case(
            "ego-cuts-in-short",
            "The ego changes a few metres ahead of a faster vehicle, which hits it from behind.",
            AT_FAULT,
            CUT_IN,
            steady(_change(LEFT, 441.0, 454.0, RIGHT, 433.0), 7.0),
            Car(drive=steady(_along(RIGHT), 13.0)),
        ),
        _case(
            "ego-cuts-in-far-ahead",
            "The ego changes lanes 4 s before a faster vehicle, unbraked, runs into it.",
            NOT_AT_FAULT,
            LATE_BRAKING,
            steady(_change(LEFT, 455.0, 465.0, RIGHT, 449.0), 5.0),
            Car(drive=steady(_along(RIGHT), 13.0)),
        ),
        _case(
            "ego-cuts-in-and-brakes",
            "The ego changes in a metre ahead of a vehicle of its speed and brakes hard at once.",
            AT_FAULT,
            CUT_IN,
            Drive(way=_change(LEFT, 419.0, 443.0, RIGHT, 417.0), speeds=braking(1.0, 11.0, 5.0)),
            Car(drive=steady(_along(RIGHT), 11.0)),
        ),
        _case(
            "ego-cuts-in-and-brakes-later",
            "The ego changes in at the other's speed; 6 s later it brakes, the other does not.",
            NOT_AT_FAULT,
            REAR,
            Drive(way=_change(LEFT, 424.0, 436.0, RIGHT, 422.0), speeds=braking(8.0, 8.0, 5.0)),
            Car(drive=steady(_along(RIGHT), 8.0)),
            seconds=16.0,
        ),
        _case(
            "ego-cuts-in-and-stops",
            "The ego changes lanes, stops, and is hit from behind while it stands.",
            AT_FAULT,
            CUT_IN + "; nuPlan's class is stopped ego",
            Drive(
                way=_change(LEFT, 433.0, 444.0, RIGHT, 432.0),
                speeds=((0.0, 8.0), (1.2, 8.0), (2.1, 0.0)),
            ),
            Car(drive=meeting(_along(RIGHT), (440.5, RIGHT), 2.4, (0.0, 10.0))),
        ),
        _case(
            "ego-swipes-other-while-changing-lanes",
            "The ego changes into the lane of a vehicle beside it.",
            AT_FAULT,
            LANE,
            steady(_change(LEFT, 440.0, 465.0, RIGHT, 421.0), 10.0),
            Car(drive=steady(_along(RIGHT, 420.0), 10.0)),
        ),
        _case(
            "ego-drifts-into-other",
            "The ego drifts slowly over the line into the vehicle beside it.",
            AT_FAULT,
            LANE,
            steady(_change(LEFT, 430.0, 490.0, LEFT - 1.6, 420.0), 10.0),
            Car(drive=steady(_along(RIGHT + 0.2, 420.0), 10.0)),
        ),
        _case(
            "ego-swings-out-into-overtaker",
            "The ego moves to the left lane while a faster vehicle passes there.",
            AT_FAULT,
            LANE,
            steady(_change(RIGHT, 452.0, 466.0, LEFT, 432.0), 8.0),
            Car(drive=steady(left, 12.0)),
        ),
        _case(
            "ego-touches-front-with-its-side",
            "The ego changes lanes so that the other's front meets its rear wheel.",
            AT_FAULT,
            LANE,
            steady(_change(LEFT, 440.0, 458.0, RIGHT, 424.0), 9.0),
            Car(drive=steady(_along(RIGHT, 414.0), 11.0)),
        ),
        _case(
            "ego-swings-out-behind-slower-leader",
            "The ego goes round a slow vehicle too late and clips its rear corner.",
            AT_FAULT,
            FOLLOWING,
            steady(_change(RIGHT, 440.0, 460.0, LEFT, 411.0), 12.0),
            Car(drive=steady(_along(RIGHT, 437.0), 4.0)),
        ),
    ]


def _both() -> list[Case]:
    return [
        _case(
            "both-drift-over-the-line",
            "The ego and the vehicle beside it drift towards each other, both over the line.",
            UNDETERMINED,
            "nuPlan's classes and RSS rule 2 blame whoever leaves its lane: here both did",
            steady(_change(RIGHT, 430.0, 470.0, RIGHT + 1.35, 420.0), 10.0),
            Car(drive=steady(_change(LEFT, 430.0, 470.0, LEFT - 1.2, 420.0), 10.0)),
        ),
        _case(
            "both-change-into-the-middle-lane",
            "From both sides at once into the middle lane of the highway.",
            UNDETERMINED,
            "Vienna Convention art. 14.1 binds both; neither was in the lane before the other",
            steady(sway(lanes("highway", "eb_1_0"), 60.0, 130.0, 3.75), 25.0),
            Car(drive=steady(sway(lanes("highway", "eb_1_2"), 60.0, 130.0, -3.75), 25.0)),
            town="highway",
            end=HIGHWAY_END,
        ),
        _case(
            "ego-begins-too-near",
            "The run begins with the ego at 12 m/s, 5 m behind a standing vehicle.",
            UNDETERMINED,
            "what led to it lies before the record; UNECE R157 annex 3 needs 1.15 s before braking",
            steady(_along(RIGHT, 440.0), 12.0),
            Parked(at=(450.0, RIGHT)),
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_following(), *_others_cut_in(), *_ego_cuts_in(), *_both()]
