"""The model-predictive controller: its problem, how it drives, and what it does without a plan."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.interface import Agent
from drivora_service.agents.nmpc.agent import create
from drivora_service.agents.nmpc.plan import LastPlan
from drivora_service.agents.nmpc.problem import (
    BOX,
    BOXES,
    INPUTS,
    REFERENCE,
    STAGE_TIME,
    STAGES,
    STATES,
    CarLimits,
    Problem,
    Solution,
    problem_for,
)
from drivora_service.agents.nmpc.reference import lay_boxes
from drivora_service.agents.pdm_closed.forecast import STEP, STEPS
from drivora_service.errors import AgentError
from drivora_service.observations.trace import EgoCol, TerminalEvent
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.fetched_weights import fetched_weights
from tests.simulation.episodes import car, ego, place, run, scenario, speeds, start, track, walker

Array = NDArray[np.float64]

LIMITS = CarLimits(
    wheelbase=2.85, max_braking=8.0, max_acceleration=1.8, max_steer=0.6, max_speed=50.0
)
SPEED = 8.0
FREE = 1e3


@pytest.fixture(scope="session")
def casadi(request: pytest.FixtureRequest) -> Path:
    return fetched_weights("nmpc", request.config)


def straight(*, speed: float = SPEED) -> Array:
    """A reference along the x axis."""
    reference = np.zeros((STAGES + 1, REFERENCE))
    reference[:, 0] = speed * STAGE_TIME * np.arange(STAGES + 1)
    reference[:, 3] = speed
    reference[:, 6:] = FREE
    return reference


def solved(problem: Problem, reference: Array, boxes: Array | None = None) -> Solution:
    """A plan from the origin along the x axis, with a metre to either side."""
    state = np.array([0.0, 0.0, 0.0, SPEED, 0.0, 0.0])
    sides = np.tile((-1.0, 1.0), (STAGES + 1, 1))
    if boxes is None:
        boxes = np.full((STAGES + 1, BOXES, BOX), 500.0)
        boxes[:, :, 2:] = (0.0, 5.0, 5.0)
    states = np.column_stack((reference[:, :5], np.zeros(STAGES + 1)))
    return problem.solve(state, reference, sides, boxes, states, np.full((STAGES, INPUTS), 0.1))


def test_a_free_straight_road_is_driven_straight_on(casadi: Path) -> None:
    found = solved(problem_for(casadi, LIMITS, 40), straight())
    assert found.solved
    assert found.states[:, 1] == pytest.approx(0.0, abs=1e-3)
    assert found.states[-1, 0] == pytest.approx(SPEED * STAGES * STAGE_TIME, abs=0.1)
    assert found.inputs[:, 2:].max() < 0.05


def test_plans_keep_to_the_limits_of_the_car(casadi: Path) -> None:
    reference = straight(speed=30.0)
    reference[:, 2] = 0.8
    states = solved(problem_for(casadi, LIMITS, 100), reference).states[1:]
    assert np.abs(states[:, 5]).max() <= LIMITS.max_steer + 1e-6
    assert states[:, 4].max() <= LIMITS.max_acceleration + 1e-6
    assert states[:, 4].max() > 0.9 * LIMITS.max_acceleration


def test_a_plan_ends_before_a_halt(casadi: Path) -> None:
    reference = straight()
    reference[:, 6] = 10.0 - reference[:, 0]
    found = solved(problem_for(casadi, LIMITS, 40), reference)
    assert found.solved
    # The reference would go on at 8 m/s; the last stage is bound by nothing but it.
    assert found.states[:-1, 0].max() < 10.3


def test_a_plan_leads_round_a_box_beside_its_way(casadi: Path) -> None:
    boxes = np.full((STAGES + 1, BOXES, BOX), 500.0)
    boxes[:, :, 2:] = (0.0, 5.0, 5.0)
    boxes[:, 0] = (12.0, -1.5, 0.0, 4.0, 2.0)
    found = solved(problem_for(casadi, LIMITS, 40), straight(), boxes)
    assert found.solved
    beside = np.abs(found.states[:, 0] - 12.0) < 1.0
    assert beside.any()
    assert (found.states[beside, 1] > 0.4).all()
    assert found.states[:, 1].max() < 1.05


def test_too_few_iterations_give_no_plan(casadi: Path) -> None:
    reference = straight()
    reference[:, 6] = 10.0 - reference[:, 0]
    found = solved(problem_for(casadi, LIMITS, 1), reference)
    assert not found.solved


def test_boxes_are_laid_round_those_who_come_nearest() -> None:
    reference = straight()
    future = np.zeros((STEPS + 1, 6, 4))
    future[:, :, 0] = (30.0, 12.0, 8.0, 20.0, 16.0, 24.0)
    future[:, :, 1] = (60.0, 4.0, 3.0, 7.0, 5.0, 6.0)
    future[:, 2, 2] = 0.5 * math.pi
    future[:, 1, 0] += 3.0 * STEP * np.arange(STEPS + 1)
    boxes = np.empty((STAGES + 1, BOXES, BOX))
    lay_boxes(reference, 2.4, 0.9, future, np.full((6, 2), (4.0, 2.0)), boxes)
    assert boxes[0, :, 1].tolist() == [3.0, 4.0, 5.0, 6.0]
    # One lies across: the ego's length counts against its side.
    assert boxes[0, 0, 4] > boxes[0, 1, 4] + 1.0
    assert boxes[-1, 1, 0] == pytest.approx(12.0 + 3.0 * STAGES * STAGE_TIME)


def bend() -> tuple[Array, Array]:
    states = np.zeros((STAGES + 1, STATES))
    states[:, 0] = SPEED * STAGE_TIME * np.arange(STAGES + 1)
    states[:, 3] = SPEED
    states[:, 5] = 0.01 * states[:, 0]
    return states, np.zeros((STAGES, INPUTS))


def test_without_a_plan_the_last_one_is_steered_along_by_its_path() -> None:
    plan, step = LastPlan(0.05), 0.05
    assert plan.go_on(SPEED, 0.3) == 0.3
    _, steer = plan.take(*bend(), (100.0, 50.0))
    assert steer == pytest.approx(0.01 * SPEED * step)
    # Half as fast it comes half as far, and so to half of the angles.
    for count in (1, 2, 3):
        wanted = 0.01 * 0.5 * SPEED * step * (count + 1)
        assert plan.go_on(0.5 * SPEED, 0.0) == pytest.approx(wanted)
    assert plan.failures == 3


def test_the_next_search_begins_with_the_last_plan_a_step_on() -> None:
    plan, reference = LastPlan(0.05), straight()
    begin = np.array([0.0, 0.2, 2.0 * math.pi, SPEED, 0.0, 0.0])
    states, _ = plan.guess(begin, reference, (100.0, 50.0))
    assert states[1:, :5] == pytest.approx(reference[1:, :5])
    plan.take(*bend(), (100.0, 50.0))
    states, _ = plan.guess(begin, reference, (100.4, 50.0))
    assert states[0] == pytest.approx(begin)
    assert states[1, 0] == pytest.approx(SPEED * STAGE_TIME)
    assert states[1, 2] == pytest.approx(2.0 * math.pi)


def test_without_plans_it_brakes_and_says_so(casadi: Path) -> None:
    one = ego(place("harbour_1_0", 10), place("harbour_1_0", 130), initial_speed=SPEED)
    episode = start(scenario(one, seconds=4.0), create({"max_iterations": 1}, casadi))
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert np.nanmax(trace.log_values[:, 0, trace.log_names.index("solved")]) == 0.0
    assert speeds(trace, "ego")[-1] == 0.0
    assert np.hypot(*(track(trace, "ego")[-1] - track(trace, "ego")[0])) < SPEED**2 / 7.0
    (event,) = trace.log_events
    assert "no plan" in event.message


def test_it_goes_round_a_car_that_partly_blocks_its_lane(casadi: Path) -> None:
    what = scenario(
        ego(place("harbour_1_0", 30), place("harbour_1_0", 120), initial_speed=8.0),
        npc_vehicles=(car(place("harbour_1_0", 75, right=1.7), behavior="replay"),),
        seconds=30.0,
    )
    trace = run(what, create({}, casadi))
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts
    assert 0.3 < np.nanmax(trace.ego_values[:-1, 0, EgoCol.ROUTE_LATERAL]) < 1.2


def test_it_lets_a_walker_cross(casadi: Path) -> None:
    crossing = walker(
        place("harbour_1_0", 70, right=4.0), place("harbour_1_0", 70, right=-8.0, speed=1.4),
    )  # fmt: skip
    what = scenario(
        ego(place("harbour_1_0", 35), place("harbour_1_0", 90), initial_speed=9.0),
        npc_walkers=(crossing,), seconds=30.0,
    )  # fmt: skip
    trace = run(what, create({}, casadi))
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts
    assert np.nanmin(speeds(trace, "ego")) < 6.0


@pytest.mark.parametrize(
    "parameters", [{"horizon": 3}, {"max_iterations": 0}, {"speed_factor": 3.0}]
)
def test_parameters_that_it_does_not_take_are_refused(parameters: dict[str, object]) -> None:
    with pytest.raises(AgentError, match="agent 'nmpc'"):
        create(parameters, Path())


def test_a_folder_without_casadi_is_told_of(tmp_path: Path) -> None:
    (tmp_path / "__init__.py").write_text("raise ImportError('no such library')\n")
    # In a process of its own: this one may have CasADi already.
    code = (
        "import sys; from pathlib import Path\n"
        "from drivora_service.agents.nmpc.casadi_files import load_casadi\n"
        "from drivora_service.errors import AgentError\n"
        "try: load_casadi(Path(sys.argv[1]))\n"
        "except AgentError as error: print(error.cause, 'casadi' in sys.modules, error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("agent_install False")
    assert "drivora agents install nmpc --again" in done.stdout


@pytest.mark.slow
class TestNmpc(AgentContract):
    @pytest.fixture(autouse=True)
    def _fetch(self, casadi: Path) -> None:
        self.folder = casadi

    def make_agent(self) -> Agent:
        return create({}, self.folder)
