"""The cost a step of an ADS in a process of its own over the same ADS in the worker's process.

The example of `deploy/external-agent` drives a run; every step it is asked twice with the same
observation, once in this process and once over gRPC, the one first at even steps and the other at
odd ones, so that both find the machine alike.

    python -m benchmarks.agent_calls
"""

from __future__ import annotations

import argparse
import os
import runpy
import shutil
import statistics
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import psutil

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent, AgentContext, Control, Observation
from drivora_service.agents.remote.adapter_messages import context_view
from drivora_service.agents.remote.remote_messages import setup_request
from drivora_service.agents.remote.views import Adapter
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.execution.fork_server import ENVIRONMENT
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.model import BackgroundTraffic
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode

EXAMPLE = Path(__file__).resolve().parents[1] / "deploy" / "external-agent"


class Both:
    """Calls the ADS in process and over gRPC; uses the answer of the latter."""

    def __init__(self, here: Adapter, there: Agent) -> None:
        self._here, self._there = here, there
        self.here_s: list[float] = []
        self.there_s: list[float] = []
        self.cpu_s = {True: 0.0, False: 0.0}
        self.seen: list[int] = []
        self.differences = 0

    def setup_env(self, context: AgentContext) -> None:
        request = setup_request(context, "here")
        self._there.setup_env(context)
        log = context.log
        context.log.declare(*log.names)
        self._here.setup_env(context_view(request, type(log)()))

    def run_step(self, observation: Observation) -> Control:
        if observation.step % 2:
            here = self._ask(self._here, observation, self.here_s)
            there = self._ask(self._there, observation, self.there_s)
        else:
            there = self._ask(self._there, observation, self.there_s)
            here = self._ask(self._here, observation, self.here_s)
        self.seen.append(len(observation.objects))
        self.differences += here != there
        return there

    def _ask(self, agent: Agent | Adapter, observation: Observation, took: list[float]) -> Control:
        begun, cpu_begun = time.perf_counter(), time.process_time()
        control = agent.run_step(observation)
        took.append(time.perf_counter() - begun)
        self.cpu_s[agent is self._here] += time.process_time() - cpu_begun
        return control


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--traffic", type=int, default=40, help="background vehicles")
    options = parser.parse_args()
    os.environ.update(ENVIRONMENT)
    networks = NetworkCatalogue(shipped_networks())
    town = networks.get("signal-grid")
    documents = generate_seeds(
        town, count=options.runs, min_length=200.0, max_length=700.0, seed=3, agent="idm"
    )
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(EXAMPLE, Path(folder) / EXAMPLE.name)
        catalogue = AgentCatalogue(folder=Path(folder))
        adapter = runpy.run_path(str(EXAMPLE / "agent.py"))["RouteFollower"]
        asked: list[Both] = []
        for document in documents:
            scenario = validate_document(document, networks, None).scenario
            scenario = replace(
                scenario, background_traffic=BackgroundTraffic(count=options.traffic)
            )
            catalogue.begin_run()
            there = catalogue.create(EXAMPLE.name, {})
            assert not isinstance(there, SumoDriver)
            both = Both(adapter(), there)
            episode = Episode(plan_episode(scenario, town), [both])
            while not episode.done:
                episode.step()
            asked.append(both)
        ads = psutil.Process().children(recursive=True)
        ads_cpu = sum(sum(child.cpu_times()[:2]) for child in ads)
        catalogue.close()
    _report(asked, ads_cpu)


def _report(asked: list[Both], ads_cpu: float) -> None:
    here = [1e3 * s for both in asked for s in both.here_s]
    there = [1e3 * s for both in asked for s in both.there_s]
    over = [t - h for h, t in zip(here, there, strict=True)]
    seen = statistics.mean(count for both in asked for count in both.seen)
    print(f"{len(over)} steps, {seen:.1f} actors perceived on average")
    print(f"differing answers: {sum(both.differences for both in asked)}")
    here_cpu, worker_cpu = (sum(both.cpu_s[k] for both in asked) for k in (True, False))
    print(
        f"CPU a step: in process {1e3 * here_cpu / len(over):.3f} ms; over gRPC "
        f"{1e3 * worker_cpu / len(over):.3f} ms in the worker and "
        f"{1e3 * ads_cpu / len(over):.3f} ms in the ADS's process, its start included"
    )
    for name, values in (("in process", here), ("over gRPC", there), ("over in-process", over)):
        values = sorted(values)
        print(
            f"{name:16} median {statistics.median(values):.3f} ms, "
            f"mean {statistics.fmean(values):.3f} ms, "
            f"95 % below {values[int(0.95 * len(values))]:.3f} ms"
        )


if __name__ == "__main__":
    main()
