"""Cases inside a junction with priority.

At d1 (400, 0) of ``signal-grid`` Garden Street from the north meets Second Street, which has
priority.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drivora_service.geometry.array_shapes import FloatArray
from tests.oracles.responsibility.case import (
    AT_FAULT,
    NOT_AT_FAULT,
    Car,
    Case,
    Ego,
    Other,
)
from tests.oracles.responsibility.ways import Drive, detour, lanes, meeting, shift, straight

GRID = "signal-grid"
PRIORITY = "RSS rule 3 (right of way); Vienna Convention art. 18.2 and 18.4"
TURNING = "Vienna Convention art. 16.1 and 18.5 (turning left: give way to oncoming traffic)"
RED = "Vienna Convention art. 23.2 (red light); nuPlan judges contacts only"
VEER = "RSS rule 1 for opposite directions; Vienna Convention art. 10.1 and 13.5"
BLOCKED = "RSS rule 3: right of way is given, not taken; Vienna Convention art. 18.7"
TOO_LATE = "UNECE R157 annex 3 (too late to brake)"


def junction_case(
    name: str,
    happens: str,
    expected: str,
    source: str,
    ego: Drive,
    *others: Other,
    end: tuple[float, float],
    town: str = GRID,
    lights: Mapping[str, Any] | None = None,
    seconds: float = 14.0,
) -> Case:
    """A case with one ego inside a junction."""
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town=town,
        egos=(Ego(drive=ego, to=end),),
        others=others,
        lights=lights,
        seconds=seconds,
    )


EAST, WEST = -1.62, 1.62
EAST_END, WEST_END, NORTH_END = (470.0, EAST), (330.0, WEST), (401.62, 60.0)


def _eastbound(y: float = EAST) -> FloatArray:
    return straight((300.0, y), (500.0, y))


def _westbound(y: float = WEST) -> FloatArray:
    return straight((505.0, y), (290.0, y))


def _from_minor() -> FloatArray:
    return lanes(GRID, "-garden_1_1", ":d1_1_0", "corner_southeast_1")


def _left_turn() -> FloatArray:
    return lanes(GRID, "south_3_1", ":d1_5_0", ":d1_7_0", "garden_1_1")


def _priority() -> list[Case]:
    return [
        junction_case(
            "ego-emerges-before-priority-traffic",
            "The ego turns left from the minor road; a vehicle with priority hits its side.",
            AT_FAULT,
            PRIORITY,
            meeting(_from_minor(), (400.5, 2.0), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (401.5, WEST), 8.0, (0.0, 10.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-emerges-into-priority-traffic-with-its-front",
            "The ego emerges from the minor road and hits a passing vehicle with priority.",
            AT_FAULT,
            PRIORITY,
            meeting(_from_minor(), (399.3, 3.9), 8.3, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (399.0, WEST), 8.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "vehicle-emerges-before-ego",
            "The ego has priority and hits a vehicle that comes out of the minor road.",
            NOT_AT_FAULT,
            PRIORITY,
            meeting(_westbound(), (401.5, WEST), 8.0, (0.0, 10.0)),
            Car(drive=meeting(_from_minor(), (400.5, 2.0), 8.0, (0.0, 5.0))),
            end=WEST_END,
        ),
        junction_case(
            "vehicle-emerges-into-egos-side",
            "The ego has priority and is hit at its side by a vehicle from the minor road.",
            NOT_AT_FAULT,
            PRIORITY,
            meeting(_westbound(), (398.5, WEST), 8.0, (0.0, 9.0)),
            Car(drive=meeting(_from_minor(), (399.3, 3.9), 8.3, (0.0, 5.0))),
            end=WEST_END,
        ),
        junction_case(
            "ego-turns-left-before-oncoming",
            "The ego turns left across the way of an oncoming vehicle, which hits its side.",
            AT_FAULT,
            TURNING,
            meeting(_left_turn(), (400.0, 2.5), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (401.0, WEST), 8.1, (0.0, 10.0))),
            end=NORTH_END,
        ),
        junction_case(
            "ego-turns-left-into-oncoming-with-its-front",
            "The ego turns left and hits an oncoming vehicle with its front.",
            AT_FAULT,
            TURNING,
            meeting(_left_turn(), (399.5, 1.8), 8.2, (0.0, 5.0)),
            Car(drive=meeting(_westbound(), (398.5, WEST), 8.0, (0.0, 8.0))),
            end=NORTH_END,
        ),
        junction_case(
            "oncoming-turns-left-before-ego",
            "An oncoming vehicle turns left before the ego, which hits it with its front.",
            NOT_AT_FAULT,
            TURNING,
            meeting(_westbound(), (401.0, WEST), 8.1, (0.0, 10.0)),
            Car(drive=meeting(_left_turn(), (400.0, 2.5), 8.0, (0.0, 5.0))),
            end=WEST_END,
        ),
        junction_case(
            "oncoming-turns-left-into-egos-side",
            "An oncoming vehicle turns left into the side of the passing ego.",
            NOT_AT_FAULT,
            TURNING,
            meeting(_westbound(), (392.0, WEST), 8.0, (0.0, 8.0)),
            Car(drive=meeting(_left_turn(), (399.5, 1.8), 8.2, (0.0, 5.0))),
            end=WEST_END,
        ),
        junction_case(
            "vehicle-creeps-out-and-stops-before-ego",
            "A vehicle emerges from the minor road and stops right before the ego with priority.",
            NOT_AT_FAULT,
            PRIORITY + "; " + TOO_LATE,
            meeting(_westbound(), (402.0, WEST), 8.0, (0.0, 11.0)),
            Car(
                drive=meeting(_from_minor(), (400.3, 2.0), 7.7, (0.0, 5.0), (6.7, 5.0), (7.7, 0.0))
            ),
            end=WEST_END,
        ),
        junction_case(
            "ego-creeps-out-and-stops-before-priority-traffic",
            "The ego emerges from the minor road, stops in the way, and is hit at once.",
            AT_FAULT,
            PRIORITY + "; " + TOO_LATE + "; nuPlan's class is stopped ego",
            meeting(_from_minor(), (400.3, 2.0), 7.7, (0.0, 5.0), (6.7, 5.0), (7.7, 0.0)),
            Car(drive=meeting(_westbound(), (402.0, WEST), 8.4, (0.0, 11.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-has-blocked-the-junction",
            "The ego has stood in the junction for 5 s when a vehicle with priority hits it.",
            NOT_AT_FAULT,
            BLOCKED,
            meeting(_from_minor(), (400.3, 2.0), 4.0, (0.0, 5.0), (3.0, 5.0), (4.0, 0.0)),
            Car(drive=meeting(_westbound(), (402.0, WEST), 9.6, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-hits-vehicle-that-blocks-the-junction",
            "A vehicle has stood in the junction for 5 s; the ego with priority does not brake.",
            AT_FAULT,
            BLOCKED,
            meeting(_westbound(), (402.0, WEST), 9.6, (0.0, 9.0)),
            Car(
                drive=meeting(_from_minor(), (400.3, 2.0), 4.0, (0.0, 5.0), (3.0, 5.0), (4.0, 0.0))
            ),
            end=WEST_END,
        ),
        junction_case(
            "ego-waits-to-turn-left-and-is-hit-from-behind",
            "The ego waits in the junction to turn left; a vehicle behind runs into it.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; RSS rule 1",
            meeting(_left_turn(), (393.6, -1.4), 5.0, (0.0, 5.0), (4.0, 5.0), (5.0, 0.0)),
            Car(drive=meeting(_eastbound(), (388.0, EAST), 8.0, (0.0, 7.0))),
            end=NORTH_END,
        ),
        junction_case(
            "ego-waits-to-turn-left-and-oncoming-cuts-across",
            "The ego waits in its part of the junction; an oncoming vehicle cuts its corner.",
            NOT_AT_FAULT,
            "nuPlan: stopped ego; Vienna Convention art. 16.1",
            meeting(_left_turn(), (393.6, -1.4), 5.0, (0.0, 5.0), (4.0, 5.0), (5.0, 0.0)),
            Car(
                drive=meeting(
                    straight((505.0, WEST), (404.0, WEST), (394.0, -0.9), (388.0, WEST)),
                    (395.0, -0.6),
                    8.0,
                    (0.0, 8.0),
                )
            ),
            end=NORTH_END,
        ),
        junction_case(
            "ego-follows-into-slower-vehicle-in-junction",
            "In the junction the ego runs into the slower vehicle ahead of it.",
            AT_FAULT,
            "nuPlan: active front; RSS rule 1",
            meeting(_eastbound(), (398.0, EAST), 8.0, (0.0, 9.0)),
            Car(drive=meeting(_eastbound(), (401.0, EAST), 8.0, (0.0, 5.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-hit-from-behind-in-junction",
            "In the junction a faster vehicle runs into the ego from behind.",
            NOT_AT_FAULT,
            "nuPlan: active rear; RSS rule 1",
            meeting(_eastbound(), (401.0, EAST), 8.0, (0.0, 5.0)),
            Car(drive=meeting(_eastbound(), (398.0, EAST), 8.0, (0.0, 9.0))),
            end=EAST_END,
        ),
    ]


def _veering() -> list[Case]:
    return [
        junction_case(
            "ego-veers-into-oncoming-in-junction",
            "Straight on in the junction, the ego veers over into the side of an oncoming vehicle.",
            AT_FAULT,
            VEER,
            meeting(
                detour(300.0, EAST, (391.0, 401.0), 0.2, (402.0, 412.0), 500.0),
                (400.0, 0.2),
                9.0,
                (0.0, 9.0),
            ),
            Car(drive=meeting(_westbound(), (393.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-veers-head-on-in-junction",
            "Straight on in the junction, the ego goes over into the way of an oncoming vehicle.",
            AT_FAULT,
            VEER,
            meeting(shift(300.0, EAST, 388.0, 402.0, 1.2, 430.0), (400.0, 1.0), 9.0, (0.0, 9.0)),
            Car(drive=meeting(_westbound(), (403.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "oncoming-veers-into-ego-in-junction",
            "An oncoming vehicle veers over in the junction and touches the ego's side.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (407.0, EAST), 9.0, (0.0, 9.0)),
            Car(
                drive=meeting(
                    detour(505.0, WEST, (411.0, 399.0), -0.2, (398.0, 386.0), 290.0),
                    (400.0, -0.2),
                    9.0,
                    (0.0, 9.0),
                )
            ),
            end=EAST_END,
        ),
        junction_case(
            "oncoming-veers-head-on-in-junction",
            "An oncoming vehicle comes over in the junction and meets the ego head on.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (397.0, EAST), 9.0, (0.0, 9.0)),
            Car(
                drive=meeting(
                    shift(505.0, WEST, 412.0, 398.0, -1.2, 370.0), (400.0, -1.0), 9.0, (0.0, 9.0)
                )
            ),
            end=EAST_END,
        ),
        junction_case(
            "wrong-way-driver-comes-through-junction",
            "A vehicle that drives the wrong way meets the ego head on in the junction.",
            NOT_AT_FAULT,
            VEER,
            meeting(_eastbound(), (397.0, EAST), 9.0, (0.0, 9.0)),
            Car(drive=meeting(_westbound(EAST), (403.0, EAST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-drives-through-junction-the-wrong-way",
            "The ego drives in the oncoming lane through the junction and meets a vehicle.",
            AT_FAULT,
            VEER,
            meeting(
                straight((300.0, EAST), (345.0, EAST), (365.0, WEST), (480.0, WEST)),
                (397.0, WEST),
                9.0,
                (0.0, 9.0),
            ),
            Car(drive=meeting(_westbound(), (403.0, WEST), 9.0, (0.0, 9.0))),
            end=EAST_END,
        ),
        junction_case(
            "ego-cuts-the-corner-of-its-left-turn",
            "The ego cuts the corner of its left turn into a vehicle that waits to come out.",
            AT_FAULT,
            "Vienna Convention art. 16.1 (turning left without entering the opposite side)",
            meeting(
                straight((300.0, EAST), (388.0, EAST), (398.0, 9.0), (400.0, 40.0)),
                (396.5, 7.5),
                8.0,
                (0.0, 8.0),
            ),
            Car(
                drive=meeting(
                    lanes(GRID, "-garden_1_1", ":d1_1_0"),
                    (398.4, 11.5),
                    6.0,
                    (0.0, 5.0),
                    (4.5, 5.0),
                    (6.0, 0.0),
                )
            ),
            end=NORTH_END,
        ),
    ]


def cases() -> list[Case]:
    """All of this kind."""
    return [*_priority(), *_veering()]
