"""The cost of a run against the floor, a bare libsumo loop that places the same actors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from benchmarks.run_cost import RUN_PARTS, Parts, Tape, record, replay_tape, take_apart
from benchmarks.scenes import crowd_scene, town_scene
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.step_cost import TOWN
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.runs.report_encoding import report_to_json
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import NpcBehavior, Scenario
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

_TOWNS = ("Town01", "Town04")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Case:
    """A scene with the calls of its run.

    Attributes:
        name: Town, actors, and what SUMO drives.
        document: Canonical JSON.
        network: Its network.
        tape: Its calls of libsumo.
    """

    name: str
    document: str
    network: RoadNetwork
    tape: Tape


def _scenes(plan: Plan, catalogue: NetworkCatalogue) -> Iterator[tuple[str, Scenario]]:
    seconds = 10.0 if plan.short else 60.0
    counts = (11,) if plan.short else (11, 51)
    for actors in counts:
        crowd = crowd_scene(catalogue.get(TOWN), npcs=actors - 1, seconds=seconds)
        yield f"{TOWN}, {actors} actors", crowd
    if plan.networks is None or plan.routes is None:
        plan.remarks.append(
            f"{' and '.join(_TOWNS)}, as `--networks` and `--routes` were not given."
        )
        return
    for town in _TOWNS:
        for actors in counts:
            scene = town_scene(plan.routes, catalogue.get(town), npcs=actors - 1)
            yield f"{town}, {actors} actors", replace(scene, max_sim_time=seconds)


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=plan.networks)
    catalogue = NetworkCatalogue(setup.shipped_networks, setup.imported_networks)
    cases = []
    for name, scene in _scenes(plan, catalogue):
        first, *others = scene.npc_vehicles
        driven = (replace(first, behavior=NpcBehavior.SUMO), *others)
        for what, one in (("none", scene), ("one", replace(scene, npc_vehicles=driven))):
            network = catalogue.get(scene.map_region.town)
            cases.append(
                _Case(
                    name=f"{name}, SUMO drives {what}",
                    document=canonical_json(one),
                    network=network,
                    tape=record(one, network),
                )
            )
    trace = plan.folder / "trace.parquet"
    for case in cases:
        perform(RunSpec(run_id="warm", document=case.document), setup)

    def once() -> Iterator[Sample]:
        for case in cases:
            parts = Parts()
            with parts.of("run"):
                report = perform(RunSpec(run_id="cost", document=case.document), setup)
            assert report.status is RunStatus.FINISHED
            bare = replay_tape(case.tape, case.network.path)
            take_apart(case.document, case.network, parts, trace)
            run = parts.median_ms("run")
            yield sample(case.name, "run / floor", run / (1e3 * bare))
            yield sample(case.name, "run", run, "ms")
            yield sample(case.name, "floor", 1e3 * bare, "ms")
            for part in RUN_PARTS:
                yield sample(case.name, part, parts.median_ms(part), "ms")
            yield sample(case.name, "report", len(report_to_json(report)) / 1e3, "kB")
            yield sample(case.name, "trace file", trace.stat().st_size / 1e3, "kB")

    yield once


RUN_FLOOR = Measurement(
    name="run-cost",
    title="Cost of a run against the floor",
    about="A run of 60 s at 20 Hz (short form: 10 s) with all oracles, metrics, objectives and the "
    "hash of the trace, as a worker performs it for a search, against the cheapest bare libsumo "
    "loop that places the same actors in every step; processor time. One ego (`idm`) and reactive "
    "NPCs, of which SUMO drives none or, from the start to the end, one. Parts are measured in a "
    "run of their own; the Parquet file of the trace is not part of the run.",
    open=_open,
)
