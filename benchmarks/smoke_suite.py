"""Makes the smoke suite: searches for failures of several ADSs on all networks, and chooses.

``python -m benchmarks.smoke_suite --work FOLDER`` keeps what it has done in FOLDER and goes on from
there. Without ``--to`` nothing of the checkout is changed.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.documents import ScenarioDocument, document_text, parse_document
from drivora_service.scenario.entities import AgentDocument
from drivora_service.suites.documents import EXTENSION
from drivora_service.suites.failures import find_failures
from drivora_service.suites.results import read_results
from drivora_service.suites.suite import SuiteScenario

SEARCHED = ("idm", "idm-mobil", "pdm-closed", "plant-lite")
"""ADSs whose failures are searched for."""
PANEL = (*SEARCHED, "ad-mlp", "sumo-krauss", "sumo-eidm", "sumo-acc")
"""ADSs that drive every scenario that was found: the difficulty is how many of them fail."""
METHODS = ("random", "avfuzzer")
SIZE = 100
_DRIVER = "idm"
"""Drives the scenarios of the suite if no other ADS is named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A scenario that was found, and what the ADSs of the panel do in it.

    Attributes:
        failed_by: ADSs of the panel that fail.
        oracles: Oracles that they violate.
    """

    path: Path
    document: ScenarioDocument
    failed_by: tuple[str, ...]
    oracles: tuple[str, ...]

    @property
    def town(self) -> str:
        """Name of its road network."""
        return self.document.map_region.town


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the search, the panel and the choice; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True, help="folder of the intermediate files")
    parser.add_argument("--scenes", type=int, default=3, help="seed scenarios of each network")
    parser.add_argument("--simulations", type=int, default=60, help="budget of each campaign")
    parser.add_argument("--budget", type=int, default=150, help="simulations of a minimisation")
    parser.add_argument("--to", type=Path, help="folder of the suite to write")
    options = parser.parse_args(arguments)
    work: Path = options.work
    work.mkdir(parents=True, exist_ok=True)
    campaigns = search(work, scenes=options.scenes, simulations=options.simulations)
    export(work, campaigns)
    minimize(work, budget=options.budget)
    drive(work)
    chosen = choose(list(candidates(work)), size=SIZE)
    print(table(chosen))
    if options.to is not None:
        write_suite(options.to, chosen)
    return 0


def search(work: Path, *, scenes: int, simulations: int) -> tuple[str, ...]:
    """Runs the campaigns as one study, or goes on with it; returns their ids."""
    towns = sorted(path.name for path in shipped_networks().iterdir() if path.is_dir())
    seeds = work / "seeds"
    if not seeds.is_dir():
        for number, town in enumerate(towns, start=1):
            drivora(
                *("seeds", "generate", "--town", town, "--num", str(scenes)),
                *("--min-length", "120", "--max-length", "320", "--seed", str(number)),
                *("--out", str(seeds)),
                work=work,
            )
    study = {
        "name": "smoke suite",
        "scenarios": ["seeds"],
        "agents": [{"name": name} for name in SEARCHED],
        "methods": [{"name": name} for name in METHODS],
        "space": {"vehicles": 4, "walkers": 1},
        "oracles": ["collision", "red_light", "stop_sign", "failure_to_yield", "off_road"],
        "budget": {"simulations": simulations},
    }
    path = work / "study.yaml"
    identity = work / "study.json"
    if not identity.is_file():
        path.write_text(yaml.safe_dump(study, sort_keys=False))
        identity.write_text(drivora("study", "run", str(path), "--json", work=work))
    content = json.loads(identity.read_text())
    return tuple(one["id"] for one in content["campaign_list"])


def export(work: Path, campaigns: Sequence[str]) -> None:
    """Adds a failure of each group of every campaign to the pool."""
    pool = work / "pool"
    if not pool.is_dir():
        drivora(
            *("campaign", "export", *campaigns, "--suite", str(pool), "--each", "group"), work=work
        )


def minimize(work: Path, *, budget: int) -> None:
    """Writes the minimal form of every scenario of the pool, or the scenario if there is none."""
    small = work / "small" / "scenarios"
    small.mkdir(parents=True, exist_ok=True)
    (work / "small" / "suite.yaml").write_text("name: smoke\nscenarios: [scenarios/*.json]\n")
    for path in sorted((work / "pool" / "scenarios").glob("*.json")):
        target = small / path.name
        if target.is_file():
            continue
        run = json.loads(drivora("run", str(path), "--json", work=work))
        document = parse_document(path.read_bytes(), "json")
        with_minimal = target.with_suffix(".minimal")
        drivora(
            *("minimize", run["id"], "--budget", str(budget), "--out", str(with_minimal)),
            work=work,
            allowed=(0, 1, 2, 3),
        )
        if with_minimal.is_file():
            minimal = parse_document(with_minimal.read_bytes(), "json")
            with_minimal.unlink()
            document = minimal.model_copy(update={"extensions": document.extensions})
        target.write_text(document_text(document))


def drive(work: Path) -> None:
    """Lets every ADS of the panel drive every scenario."""
    folder = work / "panel"
    folder.mkdir(exist_ok=True)
    for agent in PANEL:
        path = folder / f"{agent}.json"
        if not path.is_file():
            drivora(
                *("suite", "run", str(work / "small"), "--agent", agent, "--results", str(path)),
                work=work,
                allowed=(0, 1, 3),
            )


def candidates(work: Path) -> Iterator[Candidate]:
    """Yields the scenarios in which every ADS of the panel could be judged."""
    paths = {path.stem: path for path in sorted((work / "small" / "scenarios").glob("*.json"))}
    documents = {name: parse_document(path.read_bytes(), "json") for name, path in paths.items()}
    scenarios = {
        name: SuiteScenario(name=name, document=document) for name, document in documents.items()
    }
    failed: dict[str, list[str]] = {name: [] for name in paths}
    oracles: dict[str, dict[str, None]] = {name: {} for name in paths}
    judged: Counter[str] = Counter()
    for agent in PANEL:
        found = find_failures(read_results(work / "panel" / f"{agent}.json"), scenarios)
        judged.update(name for name, runs in found.judged.items() if runs)
        for key in found.failures:
            oracles[key.scenario][key.oracle] = None
            if agent not in failed[key.scenario]:
                failed[key.scenario].append(agent)
    for name, path in paths.items():
        if judged[name] == len(PANEL):
            yield Candidate(
                path=path,
                document=documents[name],
                failed_by=tuple(failed[name]),
                oracles=tuple(oracles[name]),
            )


def choose(pool: Collection[Candidate], *, size: int) -> list[Candidate]:
    """Chooses scenarios that tell ADSs apart, of all networks, oracles and difficulties alike.

    Scenarios in which all or none of the panel fail are left out. One after the other, the scenario
    is taken whose network, violated oracles, number and set of failing ADSs are the rarest among
    those that were taken before.
    """
    left = [one for one in pool if 0 < len(one.failed_by) < len(PANEL)]
    chosen: list[Candidate] = []
    taken: Counter[object] = Counter()
    while left and len(chosen) < size:
        best = max(left, key=lambda one: sum(1.0 / (1 + taken[f]) for f in _features(one)))
        left.remove(best)
        chosen.append(best)
        taken.update(_features(best))
    return sorted(chosen, key=lambda one: one.path.name)


def _features(one: Candidate) -> tuple[object, ...]:
    return (one.town, one.oracles, len(one.failed_by), one.failed_by)


def write_suite(folder: Path, chosen: Sequence[Candidate]) -> None:
    """Writes the scenarios with their difficulty, in place of those that are there."""
    inside = folder / "scenarios"
    inside.mkdir(parents=True, exist_ok=True)
    for path in inside.glob("*.json"):
        path.unlink()
    for one in chosen:
        carried = one.document.extensions.get(EXTENSION)
        expected: dict[str, Any] = dict(carried) if isinstance(carried, dict) else {}
        expected["tags"] = sorted({one.town, *one.oracles})
        expected["difficulty"] = {
            "failed_by": list(one.failed_by),
            "passed_by": [agent for agent in PANEL if agent not in one.failed_by],
        }
        egos = tuple(
            ego.model_copy(update={"agent": AgentDocument(name=_DRIVER), "config_path": None})
            for ego in one.document.ego_vehicles
        )
        document = one.document.model_copy(
            update={"ego_vehicles": egos, "extensions": {EXTENSION: expected}}
        )
        (inside / one.path.name).write_text(document_text(document))


def table(chosen: Sequence[Candidate]) -> str:
    """Returns how the scenarios are distributed, as Markdown."""
    towns = Counter(one.town for one in chosen)
    oracles = Counter(oracle for one in chosen for oracle in one.oracles)
    difficulty = Counter(len(one.failed_by) for one in chosen)
    failed = Counter(agent for one in chosen for agent in one.failed_by)
    lines = [f"{len(chosen)} scenarios", ""]
    for title, counts in (
        ("network", towns),
        ("violated oracle", oracles),
        (f"failing ADSs of {len(PANEL)}", difficulty),
        ("failing ADS", failed),
    ):
        lines += [f"| {title} | scenarios |", "|---|---|"]
        lines += [f"| {name} | {count} |" for name, count in _sorted(counts)]
        lines.append("")
    return "\n".join(lines)


def _sorted(counts: Mapping[Any, int]) -> list[tuple[Any, int]]:
    return sorted(counts.items())


def drivora(*arguments: str, work: Path, allowed: Collection[int] = (0,)) -> str:
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


if __name__ == "__main__":
    raise SystemExit(main())
