from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Role, Trace
from drivora_service.oracles.verdict import Answer
from drivora_service.plotting.strip import choose_moments, draw_strip
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.plotting.test_run_picture import STEPS, verdict


@pytest.fixture(scope="module")
def network() -> RoadNetwork:
    return NetworkCatalogue(shipped_networks()).get("signal-grid")


@pytest.fixture(scope="module")
def trace(network: RoadNetwork) -> Trace:
    """An ego that drives 80 m in 10 s, and one that stands far away."""
    lane = max((lane for lane in network.lanes if lane.drivable), key=lambda lane: lane.arc[-1])
    x, y, heading = lane.position_at(0.0)
    egos = [
        SyntheticEgo(motion=Motion.steady(x, y, steps=STEPS, speed=8.0, yaw=heading)),
        SyntheticEgo(motion=Motion.steady(x + 900.0, y, steps=STEPS), id="other"),
    ]
    stone = SyntheticActor(
        motion=Motion.steady(x + 30.0, y, steps=STEPS), id="stone", role=Role.NPC_OBSTACLE
    )
    lights = {name: [p.phases[0].state] * STEPS for name, p in network.programs.items()}
    return make_trace(egos, [stone], lights=lights)


def test_moments_lead_to_the_violation(trace: Trace) -> None:
    second = round(1.0 / trace.step_length)
    moments = choose_moments(trace, [verdict(trace, 7 * second, at_fault=True)], 4)
    assert moments.steps == (4 * second, 5 * second, 6 * second, 7 * second)
    assert moments.ego == 0


def test_an_early_violation_is_followed_by_what_came_after(trace: Trace) -> None:
    second = round(1.0 / trace.step_length)
    moments = choose_moments(trace, [verdict(trace, second + 1, at_fault=True)], 4)
    assert moments.steps == (1, second + 1, 2 * second + 1, 3 * second + 1)


def test_a_run_that_ends_with_the_violation_has_fewer_moments(trace: Trace) -> None:
    moments = choose_moments(trace, [verdict(trace, 3, at_fault=True)], 12)
    assert moments.steps[0] == 3
    assert moments.steps[-1] < STEPS


def test_the_gravest_violation_is_the_one_at_fault_then_a_collision(trace: Trace) -> None:
    verdicts = [
        verdict(trace, 60, at_fault=False),
        verdict(trace, 80, oracle="off_road", at_fault=True),
        verdict(trace, 90, at_fault=True, ego="other"),
        verdict(trace, 10, oracle="discomfort", at_fault=None),
    ]
    moments = choose_moments(trace, verdicts, 3)
    assert (moments.steps[-1], moments.ego) == (90, 1)
    assert choose_moments(trace, verdicts[:2], 3).steps[-1] == 80
    assert choose_moments(trace, verdicts[:1], 3).steps[-1] == 60


def test_of_two_collisions_at_fault_the_avoidable_one_is_shown(trace: Trace) -> None:
    verdicts = [
        replace(verdict(trace, 60, at_fault=True), avoidable=Answer.NO),
        replace(verdict(trace, 90, at_fault=True), avoidable=Answer.YES),
    ]
    assert choose_moments(trace, verdicts, 3).steps[-1] == 90


def test_a_violation_that_is_asked_for_is_shown_whatever_its_gravity(trace: Trace) -> None:
    blocked = verdict(trace, 60, oracle="blocked", at_fault=None)
    verdicts = [verdict(trace, 90, at_fault=True, ego="other"), blocked]
    moments = choose_moments(trace, verdicts, 3, shown=blocked)
    assert (moments.steps[-1], moments.ego) == (60, 0)
    assert moments.mark is not None
    assert moments.mark.verdict is blocked


@pytest.mark.parametrize("oracle", ["discomfort", ""])
def test_without_a_violation_that_knows_fault_the_whole_way_is_shown(
    trace: Trace, oracle: str
) -> None:
    verdicts = [verdict(trace, 10, oracle=oracle, at_fault=None)] if oracle else []
    moments = choose_moments(trace, verdicts, 5)
    assert moments.mark is None
    assert moments.steps[0] == 0
    assert moments.steps[-1] == trace.step_count - 1
    assert np.ptp(np.diff(moments.steps)) <= 1


@pytest.mark.parametrize("count", [1, 13])
def test_a_strip_has_some_moments(trace: Trace, count: int) -> None:
    with pytest.raises(ValueError, match=f"2 to 12 moments, not {count}"):
        choose_moments(trace, [], count)


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_the_same_run_gives_the_same_bytes(
    trace: Trace, network: RoadNetwork, tmp_path: Path, suffix: str
) -> None:
    first, second = tmp_path / f"1.{suffix}", tmp_path / f"2.{suffix}"
    for target in (first, second):
        draw_strip(trace, network, [verdict(trace, 100, at_fault=True)], target, count=3)
    assert first.read_bytes() == second.read_bytes()


def test_each_moment_shows_the_ego_in_its_middle(
    trace: Trace, network: RoadNetwork, tmp_path: Path
) -> None:
    target = tmp_path / "strip.png"
    draw_strip(trace, network, [], target, count=4)
    pixels = (imread(target)[..., :3] * 255).round()
    blue = np.abs(pixels - (0x0B, 0x5F, 0xA5)).max(axis=-1) < 3
    pictures = np.array_split(blue[:, : blue.shape[1] // 4 * 4], 4, axis=1)
    for picture in pictures:
        columns = np.flatnonzero(picture.any(axis=0))
        assert len(columns)
        assert abs(columns.mean() - picture.shape[1] / 2) < 0.1 * picture.shape[1]
