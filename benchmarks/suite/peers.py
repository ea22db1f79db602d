"""Other simulators with the same number of vehicles, in the same rounds."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from benchmarks.run_cost import STEP, record
from benchmarks.scenes import crowd_scene
from benchmarks.suite.environments import Peer, PeerError, prepare_environment, start_peer
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.result import Better
from benchmarks.suite.step_cost import TOWN
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.sumo import SumoWorld
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

_SCRIPTS = Path(__file__).parent / "peer_scripts"


_OTHERS_S = 10.0
"""Simulated seconds of a round of the others, whose cost is proportional to them."""
_TRACI = "SUMO over TraCI"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Simulator:
    """A simulator that is installed.

    Attributes:
        name: Its name.
        stem: Of the names of its files in ``peer_scripts``.
        arguments: Further arguments of its script.
    """

    name: str
    stem: str
    arguments: tuple[str, ...] = ()


_INSTALLED = (
    _Simulator(name="highway-env", stem="highway_env"),
    _Simulator(name="highway-env, 20 Hz", stem="highway_env", arguments=("20", "20")),
    _Simulator(name="MetaDrive", stem="metadrive"),
)


def _write_tape(scene: Scenario, network: RoadNetwork, folder: Path) -> Path:
    """Writes the libsumo calls of a run; returns the file."""
    world = SumoWorld(network.path, step_length=STEP, seed=0, slippery=False)
    content = {
        "arguments": world._arguments,
        "step_length": STEP,
        "vehicles": len(scene.npc_vehicles),
        # libsumo's functions are named like those of TraCI, such as ``vehicle.moveToXY``.
        "steps": [
            [(*function.__qualname__.split("."), args, kwargs) for function, args, kwargs in calls]
            for calls in record(scene, network).steps[:-1]
        ],
    }
    path = folder / f"tape-{len(scene.npc_vehicles)}.json"
    path.write_text(json.dumps(content, default=float))
    return path


def _install_simulators(plan: Plan) -> Iterator[tuple[_Simulator, Path]]:
    """Yields the simulators that can be used, with the interpreters of their environments."""
    for simulator in _INSTALLED:
        requirements = _SCRIPTS / f"{simulator.stem}.txt"
        try:
            yield simulator, prepare_environment(requirements, plan.cache, install=not plan.short)
        except PeerError as error:
            plan.remarks.append(f"{simulator.name}: {error}.")


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    setup = WorkerSetup(shipped_networks=shipped_networks())
    network = NetworkCatalogue(setup.shipped_networks).get(TOWN)
    seconds = 10.0 if plan.short else 60.0
    scenes = {
        vehicles: crowd_scene(network, npcs=vehicles, seconds=seconds)
        for vehicles in ((10,) if plan.short else (10, 50))
    }
    interpreters = list(_install_simulators(plan))
    with ExitStack() as stack:
        peers: list[tuple[int, str, Peer]] = []

        def start(
            vehicles: int, name: str, python: Path, stem: str, arguments: tuple[str, ...]
        ) -> None:
            log = plan.folder / f"{stem}-{len(peers)}-{vehicles}.log"
            script = _SCRIPTS / f"{stem}_peer.py"
            one = stack.enter_context(start_peer(python, script, arguments, log))
            try:
                one.run_round()
            except PeerError as error:
                plan.remarks.append(f"{name}, {vehicles} vehicles: {error}.")
            else:
                peers.append((vehicles, name, one))

        for vehicles, scene in scenes.items():
            perform(RunSpec(run_id="warm", document=canonical_json(scene)), setup)
            for simulator, python in interpreters:
                told = (str(vehicles), str(_OTHERS_S), *simulator.arguments)
                start(vehicles, simulator.name, python, simulator.stem, told)
            if find_spec("sumo") is None or find_spec("traci") is None:
                plan.remarks.append(f"{_TRACI}: eclipse-sumo and traci are not installed.")
            else:
                tape = _write_tape(scene, network, plan.folder)
                start(vehicles, _TRACI, Path(sys.executable), "traci", (str(tape),))

        def once() -> Iterator[Sample]:
            for vehicles, scene in scenes.items():
                case = f"{vehicles} vehicles beside the ego"
                spec = RunSpec(run_id="ours", document=canonical_json(scene))
                begun = time.process_time()
                report = perform(spec, setup)
                ours = seconds / (time.process_time() - begun)
                assert report.status is RunStatus.FINISHED
                yield sample(case, "Drivora", ours, "x real time", Better.HIGHER)
                for number, name, one in peers:
                    if number == vehicles:
                        answer = one.run_round()
                        theirs = answer.times_real
                        with_them = (
                            name
                            if answer.vehicles == vehicles
                            else (f"{name} ({answer.vehicles} vehicles)")
                        )
                        yield sample(case, with_them, theirs, "x real time", Better.NEITHER)
                        yield sample(
                            case, f"Drivora / {with_them}", ours / theirs, "", Better.HIGHER
                        )

        yield once


PEERS = Measurement(
    name="peers",
    title="Other simulators",
    about="Simulated seconds a processor second, with the same number of vehicles, in the same "
    "rounds. Drivora: a whole run of 60 s (short form: 10 s) at 20 Hz on `highway`, with loading, "
    "oracles, metrics, objectives and hash; one ego (`idm`) and reactive NPCs. highway-env: "
    "`highway-v0` with its defaults (15 Hz, one decision a second), and with the step length and "
    "the decisions of Drivora (20 Hz, a decision and an observation in each step). MetaDrive: its "
    "defaults on six straight blocks (50 Hz, ten decisions a second). TraCI: SUMO as a process of "
    "its own, over a socket, which is told every placement of the same run and steps, and nothing "
    "else. "
    "highway-env and MetaDrive simulate 10 s a round; starts and resets of the others are not "
    "counted. Simulators differ in what they simulate.",
    open=_open,
)
