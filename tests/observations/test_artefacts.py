from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.metrics.built_in_metrics import measure
from drivora_service.observations.artefacts import ArtefactKind, find_artefact, has_jumped
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Contact, TerminalEvent, Trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.artefact_verdicts import find_artefact_verdicts
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, make_trace
from tests.oracles.judging import on_lane

STEPS, STEP = 80, 50
SCORES = (
    "driving_score", "driving_score_1_0", "driving_score_2_0", "route_completion",
    "infraction_penalty", "success", "nuplan_closed_loop", "nuplan_no_at_fault_collision",
    "nuplan_making_progress", "nuplan_time_to_collision",
)  # fmt: skip


def jumping(step: int = STEP, aside: float = 3.5, speed: float = 4.0) -> Motion:
    """The motion of a vehicle beside the ego that is in the ego's lane from ``step`` on."""
    motion = Motion.steady(36.0 - speed * 0.05 * step, aside, steps=STEPS, speed=speed)
    motion.states[step:, Col.Y] -= aside
    return motion


def spoilt(*others: SyntheticActor, contacts: tuple[Contact, ...] = ()) -> Trace:
    """A run whose ego is touched in row ``STEP`` by the first of the others."""
    ego = replace(
        on_lane(motion=Motion.steady(11.0, 0.0, steps=STEPS, speed=10.0)),
        end=TerminalEvent.COLLISION,
        end_step=STEP,
        route=np.array([(11.0, 0.0), (300.0, 0.0)]),
    )
    return make_trace([ego], others, contacts=contacts or (Contact(step=STEP, ego=0, other=1),))


def judge(trace: Trace) -> tuple[Verdict, ...]:
    return judge_all(trace, straight_road(), default_oracles())


def test_what_no_speed_explains_is_a_jump() -> None:
    before, after = np.zeros(len(Col)), np.zeros(len(Col))
    before[Col.VX] = after[Col.VX] = 10.0
    after[Col.X] = 0.5
    assert not has_jumped(before, after, 0.05)
    after[Col.Y] = 3.2
    assert has_jumped(before, after, 0.05)


def test_a_vehicle_that_crashes_from_50_mps_has_not_jumped() -> None:
    # Whether the record has it driven on in that step, or not.
    before, after = np.zeros(len(Col)), np.zeros(len(Col))
    before[Col.VX] = 50.0
    assert not has_jumped(before, after, 0.05)
    after[Col.X] = 2.5
    assert not has_jumped(before, after, 0.05)


def test_a_run_that_a_jump_spoilt_has_no_violation_and_no_score() -> None:
    trace = spoilt(SyntheticActor(motion=jumping()))
    verdicts = judge(trace)
    assert [v.oracle for v in verdicts if v.outcome is Outcome.VIOLATED] == []
    (verdict,) = find_artefact_verdicts(verdicts)
    assert verdict.oracle == "collision"
    assert verdict.message.startswith(
        "Artefact of the simulation at 2.50 s, not the ego's fault: npc jumped into the ego, 3.5 m"
    )
    assert verdict.at_fault is False
    assert verdict.counterpart == verdict.evidence["counterpart"] == "npc"
    metrics = measure(trace, straight_road(), verdicts)
    assert {name: metrics[name] for name in SCORES} == dict.fromkeys(SCORES)


def test_what_the_ego_did_before_is_measured_without_the_jump() -> None:
    trace = spoilt(SyntheticActor(motion=jumping()))
    (ego,) = RunView(trace, straight_road()).egos
    assert ego.count == STEP
    metrics = measure(trace, straight_road(), judge(trace))
    assert metrics["min_gap_m"] == pytest.approx(1.7, abs=0.1)
    assert metrics["comfort"] == 1.0


def test_a_vehicle_that_appears_in_the_ego_spoils_the_run() -> None:
    motion = Motion.steady(36.0, 0.0, steps=STEPS)
    trace = spoilt(SyntheticActor(motion=motion, present=np.arange(STEPS) >= STEP))
    found = find_artefact(trace, 0, 1, STEP)
    assert found is not None
    assert (found.kind, found.in_words) == (
        ArtefactKind.APPEARED,
        "npc appeared where the ego was",
    )
    assert find_artefact_verdicts(judge(trace))


def test_an_ego_that_enters_in_another_has_no_score() -> None:
    ego = on_lane(motion=Motion.steady(11.0, 0.0, steps=STEPS), start_time=STEP * 0.05)
    ego = replace(ego, route=np.array([(11.0, 0.0), (300.0, 0.0)]), end_step=STEP)
    trace = make_trace(
        [ego],
        [SyntheticActor(motion=Motion.steady(12.0, 0.0, steps=STEPS))],
        contacts=[Contact(step=STEP, ego=0, other=1)],
    )
    present = trace.present.copy()
    present[:STEP, 0] = False
    trace = replace(trace, present=present)
    (verdict,) = find_artefact_verdicts(judge(trace))
    assert "the ego appeared where npc was" in verdict.message
    assert measure(trace, straight_road(), judge(trace))["driving_score"] is None


def test_what_overlaps_from_the_beginning_was_placed_by_the_scenario() -> None:
    trace = spoilt(SyntheticActor(motion=Motion.steady(36.0, 0.0, steps=STEPS)))
    assert find_artefact(trace, 0, 1, 0) is None


def test_a_collision_in_the_same_row_counts() -> None:
    # It drove into a standing vehicle, and another jumped into it at that moment.
    standing = SyntheticActor(id="standing", motion=Motion.steady(40.0, 0.0, steps=STEPS))
    contacts = (Contact(step=STEP, ego=0, other=1), Contact(step=STEP, ego=0, other=2))
    trace = spoilt(SyntheticActor(motion=jumping()), standing, contacts=contacts)
    verdicts = judge(trace)
    assert not find_artefact_verdicts(verdicts)
    at_fault = {v.counterpart: v.at_fault for v in verdicts if v.oracle == "collision"}
    assert at_fault == {"npc": False, "standing": True}


def test_an_own_violation_before_the_jump_counts() -> None:
    trace = spoilt(SyntheticActor(motion=jumping()))
    states = trace.states.copy()
    states[:20, 0, Col.Y] -= 20.0
    lanes = trace.ego_lanes.copy()
    lanes[:20] = -1
    trace = replace(trace, states=states, ego_lanes=lanes)
    verdicts = judge(trace)
    assert "off_road" in {v.oracle for v in verdicts if v.outcome is Outcome.VIOLATED}
    assert find_artefact_verdicts(verdicts)
    metrics = measure(trace, straight_road(), verdicts)
    assert metrics["nuplan_drivable_area"] == 0.0
    # It was spoilt all the same: a run without an end has no score.
    assert metrics["nuplan_closed_loop"] is None


def test_a_jump_that_touches_no_ego_changes_nothing() -> None:
    trace = replace(
        spoilt(SyntheticActor(motion=jumping())),
        contacts=(),
        ego_ends=(TerminalEvent.TIME_LIMIT,),
    )
    assert RunView(trace, straight_road()).egos[0].artefact is None
    assert not find_artefact_verdicts(judge(trace))


def test_an_ego_that_collided_before_is_not_excused_by_a_later_jump() -> None:
    standing = SyntheticActor(id="standing", motion=Motion.steady(30.0, 0.0, steps=STEPS))
    contacts = (Contact(step=30, ego=0, other=2), Contact(step=STEP, ego=0, other=1))
    trace = spoilt(SyntheticActor(motion=jumping()), standing, contacts=contacts)
    assert RunView(trace, straight_road()).egos[0].artefact is None
    assert any(v.oracle == "collision" and v.at_fault for v in judge(trace))
