"""The parts of a run, and the cheapest bare libsumo loop that places the same actors.

The floor loads the network, makes exactly the placements that a run makes in which SUMO is in step
from the start to the end (same calls, same poses), steps SUMO, and does nothing else. The suite
alternates both in one process, so that their ratio holds on a noisy machine.
"""

from __future__ import annotations

import statistics
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import libsumo

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.feedback.objectives import score
from drivora_service.metrics.built_in_metrics import measure
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace_files.trace_file import write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import Scenario
from drivora_service.simulation import sumo
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from drivora_service.worker.integrity import snapshot_judging_code

STEP = 0.05
_STEPPING = "stepping"
STEP_PARTS = {
    _STEPPING: "step",
    "- SUMO: placements, step": "SUMO: placements, step",
    "- agent": "agent",
    "- perception, kernels": "perception, kernels",
}
"""The parts of a step, with their labels."""
RUN_PARTS = (
    "reading the document",
    "planning",
    "agents and set-up",
    _STEPPING,
    "trace",
    "oracles",
    "metrics",
    "objectives",
    "hash",
    "integrity, twice",
    "(Parquet)",
)
"""The parts of a run; the last is not done in a search."""


@dataclass
class Tape:
    """The libsumo calls of one run, in order, as functions and arguments."""

    steps: list[list[tuple[Any, tuple[object, ...], dict[str, object]]]]


def record(scene: Scenario, network: RoadNetwork) -> Tape:
    """Simulates a run with SUMO in step and records its calls, a list for each step."""
    tape = Tape(steps=[[]])
    modules = {"vehicle": libsumo.vehicle, "route": libsumo.route, "type": libsumo.vehicletype}
    wrapped = {
        "vehicle": ("add", "moveToXY", "setSpeedMode", "setLaneChangeMode", "setSpeed", "remove"),
        "route": ("add",),
        "type": ("copy", "setLength", "setWidth", "setShapeClass"),
    }
    originals = []
    for key, names in wrapped.items():
        for name in names:
            original = getattr(modules[key], name)
            originals.append((modules[key], name, original))

            def call(*args: object, _original: Any = original, **kwargs: object) -> object:
                result = _original(*args, **kwargs)  # raises before it is taped: no floor for it
                tape.steps[-1].append((_original, args, kwargs))
                return result

            setattr(modules[key], name, call)
    step = libsumo.simulationStep

    def next_step(*args: object) -> object:
        tape.steps.append([])
        return step(*args)

    libsumo.simulationStep = next_step
    try:
        agents = AgentCatalogue()
        named = [agents.create(e.agent.name, e.agent.parameters) for e in scene.ego_vehicles]
        episode = Episode(plan_episode(scene, network), named, mirrored=True)
        while not episode.done:
            episode.step()
    finally:
        libsumo.simulationStep = step
        for module, name, original in originals:
            setattr(module, name, original)
    return tape


def replay_tape(tape: Tape, network: Path) -> float:
    """Replays a tape; returns its processor seconds, reset included."""
    begun = time.process_time()
    sumo.SumoWorld(network, step_length=STEP, seed=0, slippery=False).open()
    step = libsumo.simulationStep
    for calls in tape.steps[:-1]:
        for function, args, kwargs in calls:
            function(*args, **kwargs)
        step()
    return time.process_time() - begun


@dataclass
class Parts:
    """Processor seconds by part, one value a run."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))

    @contextmanager
    def of(self, name: str) -> Iterator[None]:
        """Measures what is done within."""
        begun = time.process_time()
        yield
        self.seconds[name].append(time.process_time() - begun)

    def median_ms(self, name: str) -> float:
        """Returns the median of a part, milliseconds."""
        return 1e3 * statistics.median(self.seconds[name])


def take_apart(document: str, network: RoadNetwork, parts: Parts, trace_path: Path) -> None:
    """Does what a worker does for a run, part by part."""
    agents = AgentCatalogue()
    with parts.of("reading the document"):
        scenario = from_canonical(document)
    with parts.of("planning"):
        plan = plan_episode(scenario, network)
    with parts.of("agents and set-up"):
        named = [agents.create(e.agent.name, e.agent.parameters) for e in scenario.ego_vehicles]
        episode = Episode(plan, named, holding=True)
    traffic = episode._traffic
    in_sumo = [0.0]
    original = traffic.step

    def step_and_time(*arguments: Any) -> None:
        begun = time.perf_counter()
        original(*arguments)
        in_sumo[0] += time.perf_counter() - begun

    vars(traffic)["step"] = step_and_time  # of this object alone, to time it
    begun = time.perf_counter()
    with parts.of(_STEPPING):
        while not episode.done:
            episode.step()
    # Parts of a step are shares of wall time: a processor clock costs as much as some of them.
    wall = time.perf_counter() - begun
    stepping = parts.seconds[_STEPPING][-1]
    agent = sum(episode.agent_seconds().values()) / wall
    parts.seconds["- SUMO: placements, step"].append(stepping * in_sumo[0] / wall)
    parts.seconds["- agent"].append(stepping * agent)
    parts.seconds["- perception, kernels"].append(stepping * (1.0 - agent - in_sumo[0] / wall))
    with parts.of("trace"):
        trace = episode.finish()
    with parts.of("oracles"):
        view = RunView(trace, network)
        verdicts = judge_all(trace, network, default_oracles(), view=view)
    with parts.of("metrics"):
        measure(trace, network, verdicts, view=view)
    with parts.of("objectives"):
        score(trace, network, view=view)
    with parts.of("hash"):
        trace_sha256(trace)
    with parts.of("integrity, twice"):
        snapshot_judging_code().changes()
        snapshot_judging_code().changes()
    with parts.of("(Parquet)"):
        write_trace(trace, trace_path)
