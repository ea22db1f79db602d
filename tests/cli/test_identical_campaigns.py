"""The same campaign with one worker, and with two where it is killed: by every method.

The engine alone is resumed at every evaluation by a fast test (`tests/campaigns/search`).
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import yaml

from drivora_service.cli.campaigns.campaign_files import shipped_campaigns
from tests.campaigns.analytic import sequence
from tests.cli.campaigns.test_campaign_commands import begin_campaign, evaluations, wait_until_told
from tests.cli.conftest import Drivora

MOTORWAY = "late-braking"
JUNCTION = "side-collision"


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """A method's campaign, in which it makes each of its steps within the budget.

    Attributes:
        campaign: The shipped campaign that is changed.
        origins: Candidates of each of these must occur.
        parameters: Of the method.
        simulations: The budget.
    """

    campaign: str = MOTORWAY
    origins: frozenset[str]
    parameters: dict[str, Any] = field(default_factory=dict)
    simulations: int = 28


METHODS = {
    "random": Search(origins=frozenset({"initial"})),
    # Restarts soon, and local searches from the first new best.
    "avfuzzer": Search(
        origins=frozenset({"initial", "mutation", "crossover", "restart", "local mutation"}),
        parameters={"stall": 1, "local_after": 0, "local_generations": 1},
        simulations=48,
    ),
    # Seeds soon count as exhausted.
    "behavexplor": Search(
        origins=frozenset({"initial", "mutation", "redraw"}), parameters={"noise_energy": 1.2}
    ),
    "samota": Search(
        origins=frozenset({"initial", "best", "uncertain", "local"}), parameters={"initial": 12}
    ),
    "doppeltest": Search(
        campaign=JUNCTION, origins=frozenset({"initial", "mutation", "crossover"})
    ),
    "lawbreaker": Search(
        origins=frozenset({"initial", "mutation", "crossover", "restart"}),
        parameters={"population": 8, "generations": 3},
    ),
    # Several seeds within the budget.
    "drivefuzz": Search(
        origins=frozenset(f"{part} added" for part in ("vehicle", "walker", "obstacle", "patch")),
        parameters={"cycles": 3, "mutants": 4},
    ),
    "decictor": Search(origins=frozenset({"reference", "mutation"})),
}

SPACES: dict[str, dict[str, Any]] = {
    "drivefuzz": {"vehicles": 4, "walkers": 1, "obstacles": 1, "patches": 2, "optional": True}
}
"""What differs from the campaign's own space."""


def campaign_of(method: str, folder: Path) -> Path:
    """Writes the file of a campaign, and returns its path."""
    search = METHODS[method]
    document = yaml.safe_load((shipped_campaigns() / f"{search.campaign}.yaml").read_text())
    document["scenario"]["file"] = str(shipped_campaigns() / document["scenario"]["file"])
    document["tester"] = {"name": method, "parameters": search.parameters}
    document["space"] = {**document["space"], **SPACES.get(method, {})}
    if method == "decictor":
        document["space"] |= {"optional": True, "behavior": "replay"}
        document["oracles"] = ["collision", "non_optimal_decision"]
    document["budget"] = {"simulations": search.simulations}
    path = folder / f"{method}.yaml"
    path.write_text(yaml.safe_dump(document))
    return path


def result_of(method: str, folder: Path, drivora: Drivora, campaign_id: str) -> tuple[object, ...]:
    """Returns the evaluations and the failures of a campaign of a method."""
    shown = drivora("campaign", "show", campaign_id, "--json").json()
    assert shown["state"] == "finished"
    assert shown["simulations"] == METHODS[method].simulations
    records = evaluations(folder, campaign_id)
    assert METHODS[method].origins <= {record.proposal.origin for record in records}
    traces = [record.report.trace_sha256 for record in records]
    # Their addresses name the campaign.
    failures = json.dumps(shown["failures"], sort_keys=True).replace(campaign_id, "")
    return sequence(records), traces, failures


def by_way(method: str, folder: Path, drivora: Drivora) -> dict[str, tuple[object, ...]]:
    """Returns the result of a campaign by the way in which it was run."""
    path = campaign_of(method, folder)
    process = begin_campaign(folder, "run", path, "--workers", "2")
    campaign_id = wait_until_told(folder, process, 0)
    process.kill()
    told = len(evaluations(folder, campaign_id))
    assert 0 < told < METHODS[method].simulations
    process = begin_campaign(folder, "resume", campaign_id, "--workers", "1")
    wait_until_told(folder, process, told)
    process.kill()
    assert len(evaluations(folder, campaign_id)) < METHODS[method].simulations
    ended = drivora("campaign", "resume", campaign_id, "--workers", "2", "--json")
    assert ended.code == 0, ended.err
    found = {"K = 2, killed twice": result_of(method, folder, drivora, campaign_id)}

    ended = drivora("campaign", "run", path, "--workers", "1", "--json")
    assert ended.code == 0, ended.err
    found["K = 1"] = result_of(method, folder, drivora, ended.json()["id"])
    return found


def digest(result: tuple[object, ...]) -> str:
    """Returns a short name of a result."""
    return hashlib.sha256(repr(result).encode()).hexdigest()[:16]


@pytest.mark.slow(seconds=15)
@pytest.mark.parametrize("method", METHODS)
def test_workers_and_kills_change_nothing(method: str, drivora: Drivora, tmp_path: Path) -> None:
    found = by_way(method, tmp_path, drivora)
    for way, result in found.items():
        # Shown by `pytest -rP`.
        print(f"| {method} | {way} | {digest(result)} |")
    killed, whole = found.values()
    assert killed == whole
