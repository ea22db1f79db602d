"""The cost of a run against the cheapest bare libsumo loop that places the same actors.

The run: one ego (`idm`) and ten reactive NPCs, 60 s at 20 Hz, with reset, all oracles, metrics and
the written trace. The floor replays exactly the placements that the run made (same calls, same
poses) and steps SUMO, with the reset and the adding of the vehicles, and nothing else. Both
alternate in one process, so that the ratio holds on a noisy machine.

    python benchmarks/run_cost.py --networks MAPS --routes ROUTES --town Town01 --repeat 9
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import statistics
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import libsumo

from benchmarks.scenes import town_scene
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.simulation import sumo
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

STEP = 0.05


@dataclass
class Tape:
    """The libsumo calls of one run, in order, as functions and arguments."""

    steps: list[list[tuple[Any, tuple[object, ...], dict[str, object]]]]


def record(spec: RunSpec, setup: WorkerSetup) -> Tape:
    """Performs a run and records its calls on vehicles, a list for each step."""
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
        perform(spec, setup)
    finally:
        libsumo.simulationStep = step
        for module, name, original in originals:
            setattr(module, name, original)
    return tape


def floor(tape: Tape, network: Path) -> float:
    """Replays a tape; returns its wall seconds, reset included."""
    begun = time.process_time()
    sumo.open_world(network, step_length=STEP, seed=0, slippery=False)
    step = libsumo.simulationStep
    for calls in tape.steps[:-1]:
        for function, args, kwargs in calls:
            function(*args, **kwargs)
        step()
    return time.process_time() - begun


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=Path, required=True, help="folder of NAME.net.xml")
    parser.add_argument("--routes", type=Path, required=True, help="Leaderboard 1.0 route file")
    parser.add_argument("--town", default="Town01")
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--profile", action="store_true")
    options = parser.parse_args()
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=options.networks)
    catalogue = NetworkCatalogue(setup.shipped_networks, setup.imported_networks)
    network = catalogue.get(options.town)
    scene = replace(town_scene(options.routes, network, npcs=10), max_sim_time=60.0)
    with tempfile.TemporaryDirectory() as folder:
        spec = RunSpec(
            run_id="cost",
            document=canonical_json(scene),
            trace_path=str(Path(folder) / "trace.parquet"),
        )
        tape = record(spec, setup)
        ours, bare, stepping = [], [], []
        for _ in range(options.repeat):
            begun = time.process_time()
            report = perform(spec, setup)
            ours.append(time.process_time() - begun)
            stepping.append(report.step_cost_us * 1e-6 * (report.steps - 1))
            bare.append(floor(tape, network.path))
        print(f"{options.town}: {report.steps} rows, status {report.status.value}")
        ratios = sorted(a / b for a, b in zip(ours, bare, strict=True))
        print(
            f"run    {1e3 * statistics.median(ours):8.1f} ms  of which stepping "
            f"{1e3 * statistics.median(stepping):.1f} ms"
        )
        print(f"floor  {1e3 * statistics.median(bare):8.1f} ms")
        print(f"least  {1e3 * min(ours):8.1f} ms against {1e3 * min(bare):.1f} ms")
        print(
            f"ratio  {statistics.median(ratios):8.2f}     min {ratios[0]:.2f} max {ratios[-1]:.2f}"
        )
        if options.profile:
            profile = cProfile.Profile()
            profile.runcall(perform, spec, setup)
            pstats.Stats(profile).sort_stats("tottime").print_stats(25)


if __name__ == "__main__":
    main()
