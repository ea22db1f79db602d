"""The searches for failures, their minimal forms, and what every ADS of the panel does in them.

Each step runs commands of Drivora, keeps what it made in the work folder, and leaves out what is
there already. A study that was interrupted is begun anew.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from benchmarks.smoke_suite.panel import PANEL, Driver
from drivora_service.cli.application.command_connection import open_client
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.store.engine.chunks import batched
from drivora_service.suites.suite_results import read_results

_AT_ONCE = 8
"""Minimisations that share the workers, so that none waits at the end of another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seeds:
    """Generated seed scenarios.

    Attributes:
        scenes: Seed scenarios of each network.
        lengths_m: Least and greatest length of the egos' routes.
        first_seed: Seed of those of the first network; each further one has the next.
    """

    name: str
    scenes: int
    lengths_m: tuple[int, int]
    first_seed: int


LONG = Seeds(name="long", scenes=3, lengths_m=(120, 320), first_seed=1)
SHORT = Seeds(name="short", scenes=4, lengths_m=(80, 250), first_seed=101)


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """One study of the search.

    Attributes:
        against: Labels of the ADSs, of the panel.
        simulations: Budget of each campaign.
    """

    name: str
    seeds: Seeds
    against: tuple[str, ...]
    methods: tuple[str, ...]
    space: Mapping[str, Any]
    oracles: tuple[str, ...]
    simulations: int


SEARCHES = (
    Search(
        name="rules",
        seeds=LONG,
        against=("idm", "idm-mobil", "pdm-closed", "plant-lite"),
        methods=("random", "avfuzzer"),
        space={"vehicles": 4, "walkers": 1},
        oracles=("collision", "red_light", "stop_sign", "failure_to_yield", "off_road"),
        simulations=60,
    ),
    Search(
        name="sudden actors",
        seeds=SHORT,
        against=("idm", "idm-slow", "pdm-closed", "sumo-eidm"),
        methods=("avfuzzer", "behavexplor"),
        space={"vehicles": 3, "walkers": 3, "behavior": "replay", "lights": True},
        oracles=("collision", "red_light", "blocked"),
        simulations=40,
    ),
    Search(
        name="near misses",
        seeds=SHORT,
        against=("idm", "idm-slow", "pdm-closed"),
        methods=("avfuzzer",),
        space={"vehicles": 3, "walkers": 3, "max_walker_delay": 10},
        oracles=("collision", "near_miss"),
        simulations=40,
    ),
)


def search(work: Path) -> tuple[str, ...]:
    """Runs the studies; returns the ids of their campaigns."""
    found: list[str] = []
    for one in SEARCHES:
        identity = work / f"study {one.name}.json"
        if not identity.is_file():
            path = work / f"study {one.name}.yaml"
            path.write_text(yaml.safe_dump(_study(work, one), sort_keys=False))
            identity.write_text(run_drivora("study", "run", str(path), "--json", work=work))
        content = json.loads(identity.read_text())
        found += [campaign["id"] for campaign in content["campaign_list"]]
    return tuple(found)


def _study(work: Path, one: Search) -> dict[str, Any]:
    seeds = work / f"seeds {one.seeds.name}"
    if not seeds.is_dir():
        towns = sorted(path.name for path in shipped_networks().iterdir() if path.is_dir())
        least, most = one.seeds.lengths_m
        for seed, town in enumerate(towns, start=one.seeds.first_seed):
            run_drivora(
                *("seeds", "generate", "--town", town, "--num", str(one.seeds.scenes)),
                *("--min-length", str(least), "--max-length", str(most), "--seed", str(seed)),
                *("--out", str(seeds)),
                work=work,
            )
    return {
        "name": f"smoke suite, {one.name}",
        "scenarios": [seeds.name],
        "agents": [driver.as_agent() for driver in PANEL if driver.label in one.against],
        "methods": [{"name": name} for name in one.methods],
        "space": dict(one.space),
        "counts": "possibly_at_fault",
        "oracles": list(one.oracles),
        "budget": {"simulations": one.simulations},
    }


def export(work: Path, campaigns: Sequence[str]) -> None:
    """Adds a failure of each group of every campaign to the pool."""
    pool = work / "pool"
    if not pool.is_dir():
        run_drivora(
            *("campaign", "export", *campaigns, "--suite", str(pool), "--each", "group"),
            *("--counts", "any"),
            work=work,
        )


def drive(work: Path, suite: str) -> None:
    """Lets every ADS of the panel drive every scenario of a suite in the work folder."""
    for driver in PANEL:
        path = results_path(work, suite, driver)
        path.parent.mkdir(exist_ok=True)
        if not path.is_file():
            run_drivora(
                *("suite", "run", str(work / suite), "--agent", driver.agent),
                *(f"--agent-parameter={name}={value}" for name, value in driver.parameters),
                *("--results", str(path)),
                work=work,
                allowed=(0, 1, 3),
            )


def make_baseline(work: Path, suite: Path) -> None:
    """Writes what the ADS that drives the scenarios of a suite fails in as its baseline."""
    baseline, results = suite / "idm.baseline.json", work / "idm.json"
    baseline.unlink(missing_ok=True)
    run_drivora(
        *("suite", "run", str(suite), "--agent", "idm", "--repetitions", "10"),
        *("--results", str(results)),
        work=work,
        allowed=(0, 1),
    )
    run_drivora(
        "suite", "baseline", str(suite), str(results), "--baseline", str(baseline), work=work
    )


def results_path(work: Path, suite: str, driver: Driver) -> Path:
    """Returns the path of the results of an ADS in a suite of the work folder."""
    return work / f"panel {suite}" / f"{driver.label}.json"


def minimize(work: Path, wanted: Mapping[str, Driver], *, budget: int) -> None:
    """Writes the minimal forms of scenarios of the pool, or the scenarios that have none.

    Args:
        work: The work folder.
        wanted: For each scenario, the ADS whose failure is kept.
        budget: Simulations that the search for a minimal form may need.
    """
    small = work / "small" / "scenarios"
    small.mkdir(parents=True, exist_ok=True)
    (work / "small" / "suite.yaml").write_text("name: smoke\nscenarios: [scenarios/*.json]\n")
    left = [name for name in wanted if not (small / f"{name}.json").is_file()]
    runs = {driver: _run_ids(work, driver) for driver in PANEL}
    with open_client("", work / "data", works=True) as client:
        for some in batched(left, _AT_ONCE):
            started = {
                name: client.minimize(runs[wanted[name]][name], budget=budget).id for name in some
            }
            for name, identity in started.items():
                found = client.wait_for_minimization(identity)
                path = work / "pool" / "scenarios" / f"{name}.json"
                document = parse_document(path.read_bytes(), "json")
                if found.document is not None:
                    minimal = parse_document(found.document)
                    document = minimal.model_copy(update={"extensions": document.extensions})
                (small / path.name).write_text(document_text(document))


def _run_ids(work: Path, driver: Driver) -> dict[str, str]:
    results = read_results(results_path(work, "pool", driver))
    return {run.scenario: run.run_id for run in results.runs if run.repetition == 0}


def run_drivora(*arguments: str, work: Path, allowed: Collection[int] = (0,)) -> str:
    """Runs a command of Drivora and returns what it printed.

    Raises:
        RuntimeError: It ended with another exit code than the allowed ones.
    """
    done = subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", *arguments],
        env={**os.environ, "DRIVORA_DATA_DIR": str(work / "data")},
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode not in allowed:
        raise RuntimeError(f"drivora {' '.join(arguments[:3])} … ended with {done.returncode}")
    return done.stdout
