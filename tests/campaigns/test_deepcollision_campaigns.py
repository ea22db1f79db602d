"""Campaigns of DeepCollision with real runs: any number of workers, killed and resumed."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.errors import InvalidDocument
from drivora_service.runs.adversary import EXTENSION
from drivora_service.scenario.canonical import from_canonical
from drivora_service.search.testers.deepcollision import tester as module
from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
from drivora_service.store.database import Database
from tests.campaigns.analytic import sequence
from tests.campaigns.records.test_stored_campaigns import Campaigns, after


@pytest.fixture
def campaigns(database: Database, catalogues: Catalogues, tmp_path: Path) -> Campaigns:
    return Campaigns(database, catalogues, tmp_path)


@pytest.fixture
def adversarial(content: dict[str, Any]) -> dict[str, Any]:
    """A campaign whose adversary begins to learn within its budget."""
    parameters = {
        "interval": 4.0, "hidden": 24, "learning_starts": 10, "exploration_steps": 20,
        "checkpoint_every": 4,
    }  # fmt: skip
    return {**content, "tester": {"name": "deepcollision", "parameters": parameters}}


@pytest.mark.slow(seconds=90)
def test_workers_kills_and_checkpoints_do_not_change_a_campaign(
    campaigns: Campaigns, adversarial: dict[str, Any]
) -> None:
    pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
    alone = campaigns.create(adversarial)
    assert campaigns.run(alone, 1).state is CampaignState.FINISHED
    whole = campaigns.evaluations(alone)
    assert len(whole) == 12
    assert {record.proposal.origin for record in whole} == {"random", "policy"}

    paused = campaigns.create(adversarial)
    for count in (5, 4):
        watcher, _ = after(count)
        assert campaigns.run(paused, 2, watcher).state is CampaignState.PAUSED
    # Without the latest checkpoint, the one before it is gone on from; without any, none is needed.
    checkpoints = sorted((campaigns.folder(paused).path / "checkpoints").iterdir())
    assert [path.name for path in checkpoints] == ["00000004.checkpoint", "00000008.checkpoint"]
    assert campaigns.run(paused, 2).state is CampaignState.FINISHED
    assert sequence(campaigns.evaluations(paused)) == sequence(whole)

    lost = campaigns.create(adversarial)
    watcher, _ = after(9)
    assert campaigns.run(lost, 2, watcher).state is CampaignState.PAUSED
    shutil.rmtree(campaigns.folder(lost).path / "checkpoints")
    assert campaigns.run(lost, 1).state is CampaignState.FINISHED
    assert sequence(campaigns.evaluations(lost)) == sequence(whole)

    journal = StoreJournal(campaigns.database, alone)
    failures = journal.failures()
    assert failures
    # Each failure was run again from its document alone, without the adversary.
    assert {failure.confirmation for failure in failures} == {Confirmation.CONFIRMED}
    told = [from_canonical(journal.document(one.evaluation)).extensions for one in failures]
    assert any(extensions.get(EXTENSION) for extensions in told)
    assert "torch" in campaigns.record(alone).versions


def test_without_the_extra_a_campaign_is_refused_and_the_extra_named(
    adversarial: dict[str, Any], catalogues: Catalogues, monkeypatch: pytest.MonkeyPatch
) -> None:
    from drivora_service.campaigns.search.search_preparation import prepare_search

    monkeypatch.setattr(module, "find_spec", lambda _name: None)
    valid = read_campaign(adversarial, catalogues)
    with pytest.raises(InvalidDocument, match=r"\.\[adversary\]") as caught:
        prepare_search(valid, catalogues, run_prefix="x")
    assert caught.value.problems[0].pointer == "/tester"
