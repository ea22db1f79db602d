"""The shipped campaigns find the failures on their page."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import ValidCampaign, read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.confirmation import confirm_failures
from drivora_service.campaigns.search.engine import Engine, Told
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.cli.campaigns.campaign_files import read_campaign_file, shipped_campaigns
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.store.campaigns.campaign_records import CampaignRequest, Confirmation
from drivora_service.worker.setup import WorkerSetup

CAMPAIGNS = sorted(shipped_campaigns().glob("*.yaml"))
_PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "failures-found.md"


@dataclass(frozen=True, slots=True, kw_only=True)
class Discovery:
    """A failure that a campaign finds, and its evaluation.

    Attributes:
        kind: Kind of the failure.
        at_fault: Whether the ego is responsible; ``None`` where the oracle knows no fault.
        evidence: Part of what the verdict must say.
    """

    number: int
    kind: str
    at_fault: bool | None
    evidence: dict[str, Any]


DISCOVERIES = {
    "side-collision": Discovery(
        number=62,
        kind="collision|junction market_orchard|ego, side",
        at_fault=True,
        evidence={"counterpart_role": "ego", "face": "side", "other_speed": 0.0},
    ),
    "late-braking": Discovery(
        number=16,
        kind="collision|road eb_1|npc_vehicle, front",
        at_fault=True,
        evidence={"face": "front", "rule": "following"},
    ),
    "standstill": Discovery(
        number=62, kind="blocked|junction market_orchard", at_fault=None, evidence={"since": 23.35}
    ),
    "deadlock": Discovery(
        number=89,
        kind="deadlock|junction market_church|cycle of 3",
        at_fault=None,
        evidence={"cycle": ["ego_1", "ego_6", "ego_3"]},
    ),
}


def read(path: Path, catalogues: Catalogues) -> ValidCampaign:
    return read_campaign(read_campaign_file(path), catalogues)


@pytest.mark.parametrize("path", CAMPAIGNS, ids=lambda path: path.stem)
def test_every_campaign_can_be_run(path: Path, catalogues: Catalogues) -> None:
    valid = read(path, catalogues)
    assert valid.notes == ()
    assert valid.campaign.agent is not None
    assert valid.campaign.agent.name == "idm"
    assert valid.campaign.budget <= 200
    prepare_search(valid, catalogues, run_prefix="example")


def test_every_campaign_has_a_discovery_on_its_page() -> None:
    assert [path.stem for path in CAMPAIGNS] == sorted(DISCOVERIES)
    page = _PAGE.read_text()
    for name, discovery in DISCOVERIES.items():
        section = re.split(r"^## ", page.rsplit(f"campaigns/{name}.yaml", 1)[1], flags=re.M)[0]
        assert f"#{discovery.number}" in section, name


@pytest.mark.slow
@pytest.mark.parametrize("name", DISCOVERIES)
def test_the_failure_is_found_and_happens_again(
    name: str, catalogues: Catalogues, tmp_path: Path
) -> None:
    discovery = DISCOVERIES[name]
    valid = read(shipped_campaigns() / f"{name}.yaml", catalogues)
    search = prepare_search(valid, catalogues, run_prefix=name)
    journal, told = MemoryJournal(), 0

    def count(_told: Told) -> None:
        nonlocal told
        told += 1

    def requested() -> CampaignRequest:
        return CampaignRequest.PAUSE if told > discovery.number else CampaignRequest.NONE

    setup = WorkerSetup(shipped_networks=shipped_networks())
    with LocalExecutor(slots=2, setup=setup, folder=tmp_path / "search") as executor:
        evaluator = LocalEvaluator(executor)
        Engine(search, evaluator, journal, requested=requested, on_told=count).run()
    found = [failure for failure in journal.failures() if failure.evaluation == discovery.number]
    (failure,) = (failure for failure in found if failure.kind == discovery.kind)
    assert failure.verdict.at_fault is discovery.at_fault
    assert {**failure.verdict.evidence, **discovery.evidence} == failure.verdict.evidence

    with LocalExecutor(slots=2, setup=setup, folder=tmp_path / "again") as executor:
        confirm_failures(journal, LocalEvaluator(executor), run_prefix=name, trace_address=None)
    assert {failure.confirmation for failure in journal.failures()} == {Confirmation.CONFIRMED}
