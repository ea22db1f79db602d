from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.image import imread

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.recorded_conditions import PATCHES_KEY
from drivora_service.observations.trace import Role, Trace
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.violation_marks import marks_of
from drivora_service.plotting.picture_view import view_of_run
from drivora_service.plotting.run_picture import draw_run
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

STEPS = 200


@pytest.fixture(scope="module")
def network() -> RoadNetwork:
    return NetworkCatalogue(shipped_networks()).get("signal-grid")


@pytest.fixture
def trace(network: RoadNetwork) -> Trace:
    lane = max((lane for lane in network.lanes if lane.drivable), key=lambda lane: lane.arc[-1])
    x, y, heading = lane.position_at(0.0)
    ego = SyntheticEgo(motion=Motion.steady(x, y, steps=STEPS, speed=8.0, yaw=heading))
    stone = SyntheticActor(
        motion=Motion.steady(x + 20.0, y, steps=STEPS), id="stone", role=Role.NPC_OBSTACLE
    )
    lights = {name: [p.phases[0].state] * STEPS for name, p in network.programs.items()}
    return make_trace([ego], [stone], lights=lights)


def verdict(trace: Trace, step: int, **values: object) -> Verdict:
    x, y = trace.states[step, 0, :2]
    given: dict[str, object] = {
        "oracle": "collision",
        "ego": "ego",
        "outcome": Outcome.VIOLATED,
        "message": "",
        "time": float(trace.times[step]),
        "step": step,
        "location": (float(x), float(y)),
        **values,
    }
    return Verdict(**given)  # type: ignore[arg-type] # fields of a verdict by name


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_the_same_run_gives_the_same_bytes(
    trace: Trace, network: RoadNetwork, tmp_path: Path, suffix: str
) -> None:
    first, second = tmp_path / f"1.{suffix}", tmp_path / f"2.{suffix}"
    for target in (first, second):
        draw_run(trace, network, [verdict(trace, 50)], target)
    assert first.read_bytes() == second.read_bytes()


def test_a_violation_shows(trace: Trace, network: RoadNetwork, tmp_path: Path) -> None:
    without, with_one = tmp_path / "without.png", tmp_path / "with.png"
    draw_run(trace, network, [], without)
    draw_run(trace, network, [verdict(trace, 50)], with_one)

    def reds(path: Path) -> int:
        pixels = imread(path)[..., :3] * 255
        return int((np.abs(pixels - (0xC1, 0x12, 0x1F)).max(axis=-1) < 3).sum())

    assert reds(without) == 0
    assert reds(with_one) > 300


def test_trails_coloured_by_time_and_svg_are_well_formed(
    trace: Trace, network: RoadNetwork, tmp_path: Path
) -> None:
    target = tmp_path / "run.svg"
    draw_run(trace, network, [], target, color_by="time")
    assert ElementTree.parse(target).getroot().tag.endswith("svg")


def test_other_files_are_refused(trace: Trace, network: RoadNetwork, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.svg or \.png"):
        draw_run(trace, network, [], tmp_path / "run.gif")


def test_the_view_holds_trail_goal_and_verdicts(trace: Trace) -> None:
    far = verdict(trace, 0, location=(500.0, -300.0))
    view = view_of_run(trace, [far])
    assert view.holds(*trace.states[0, 0, :2])
    assert view.holds(*trace.ego_routes[0].goal)
    assert view.holds(500.0, -300.0)


def test_marks_are_numbered_in_order_of_time(trace: Trace) -> None:
    verdicts = [
        verdict(trace, 80),
        verdict(trace, 0, oracle="destination", time=None, location=None),
        verdict(trace, 20),
        verdict(trace, 10, outcome=Outcome.PASSED),
    ]
    assert [(m.number, m.verdict.time) for m in marks_of(verdicts)] == [
        (1, verdicts[2].time),
        (2, verdicts[0].time),
        (3, None),
    ]


def test_slippery_patches_are_drawn_and_named(
    trace: Trace, network: RoadNetwork, tmp_path: Path
) -> None:
    x, y, yaw = trace.states[100, 0, :3].tolist()
    patch = {"id": "ice", "x": x, "y": y, "z": 0.0, "yaw": yaw, "length": 30.0, "width": 6.0}
    icy = replace(trace, meta={**trace.meta, PATCHES_KEY: [{**patch, "friction": 0.15}]})
    dry, wet = tmp_path / "dry.svg", tmp_path / "icy.svg"
    draw_run(trace, network, [], dry)
    draw_run(icy, network, [], wet)
    draw_run(icy, network, [], again := tmp_path / "again.svg")
    assert again.read_bytes() == wet.read_bytes()
    fill = "fill: url(#h"
    assert "slippery, friction 0.15" in wet.read_text()
    # On the map and in the legend.
    assert wet.read_text().count(fill) == 2
    assert "slippery" not in dry.read_text()
    assert fill not in dry.read_text()
