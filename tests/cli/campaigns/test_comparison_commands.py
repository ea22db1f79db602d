"""``drivora campaign compare`` and ``report`` on campaigns that were really run."""

from __future__ import annotations

import contextlib
import copy
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import new_campaign, run_stored
from drivora_service.execution.executor import Limits
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.database import open_database
from drivora_service.worker.setup import WorkerSetup
from tests.cli.conftest import Drivora
from tests.forked_service import forked_service

TESTERS = ("random", "avfuzzer")
SEEDS = (1, 2, 3)


def content(tester: str, seed: int) -> dict[str, Any]:
    return {
        "name": f"study-{tester}-{seed}",
        "tester": {"name": tester},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": 10},
        "seed": seed,
    }


@pytest.fixture
def study(tmp_path: Path) -> list[str]:
    """Ids of two testers' campaigns, three each, in the data folder that commands use."""
    data = tmp_path / "data"
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    ids = []
    with (
        contextlib.closing(database),
        tempfile.TemporaryDirectory() as folder,
        contextlib.closing(LOCAL.create(_context(Path(folder)))) as shared,
    ):

        @contextlib.contextmanager
        def evaluator(_workers: int | None) -> Iterator[Evaluator]:
            yield shared

        for tester in TESTERS:
            for seed in SEEDS:
                valid = read_campaign(content(tester, seed), catalogues)
                with database.write() as transaction:
                    made = transaction.campaigns.create(new_campaign(valid)).id
                run_stored(
                    database,
                    made,
                    CampaignFolder(data / "campaigns", made),
                    catalogues=catalogues,
                    evaluator=evaluator,
                )
                ids.append(made)
    return ids


def _context(folder: Path) -> EvaluatorContext:
    setup = WorkerSetup(shipped_networks=shipped_networks())
    return EvaluatorContext(workers=2, setup=setup, limits=Limits(), folder=folder)


@pytest.mark.slow
def test_real_campaigns_are_compared_and_reported(
    drivora: Drivora, study: list[str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    ended = drivora("campaign", "compare", "study-*", "--out", out, "--json")
    assert ended.code == 0, ended.err
    result = ended.json()
    assert result["baseline"] == "random"
    assert [f["campaign"] for f in result["campaigns"]] == study
    assert {f["simulations"] for f in result["campaigns"]} == {10}
    assert {row["method"] for row in result["differences"]} == {"avfuzzer"}
    assert all(
        0.0 <= row["low"] <= row["a12"] <= row["high"] <= 1.0 for row in result["differences"]
    )
    assert all(0.0 < f["network_coverage"] < 1.0 for f in result["campaigns"])
    kinds = max(f["avoidable_kinds"] for f in result["campaigns"])
    assert sorted(path.name for path in out.iterdir()) == sorted(
        ["comparison.csv", "comparison.md", "figures.csv", "survival.csv"]
        + [
            f"{name}.{suffix}"
            for name in (
                "avoidable-found",
                "effects",
                "failures-found",
                "first-avoidable",
                "first-failure",
                "values",
                *(f"survival-{k}" for k in (1, 2, 3, 5) if k <= max(kinds, 1)),
            )
            for suffix in ("png", "svg")
        ]
    )

    failing = next(f for f in result["campaigns"] if f["failing"])
    far = tmp_path / "far" / "first.md"
    with forked_service(tmp_path / "data", workers=1) as url:
        server = ("--server", url)
        asked = drivora("campaign", "compare", "study-*", *server, "--json")
        # Another data folder: all comes from the service.
        elsewhere = {"DRIVORA_DATA_DIR": str(tmp_path / "elsewhere")}
        ended = drivora(
            "campaign", "report", failing["campaign"], "--out", far, *server, **elsewhere
        )
    assert asked.json() == result
    assert ended.code == 0, ended.err

    timed = drivora(
        "campaign",
        "compare",
        *study,
        "--baseline",
        "avfuzzer",
        "--equal-time",
        "--measure",
        "kinds",
    )
    assert timed.code == 0, timed.err
    assert "kinds of failures (more is better)" in timed.out
    assert "of one worker" in timed.out

    report = tmp_path / "reports" / "first.md"
    ended = drivora("campaign", "report", failing["campaign"], "--out", report)
    assert ended.code == 0, ended.err
    text = report.read_text()
    pictures = sorted((report.parent / "first-pictures").iterdir())
    assert pictures
    assert all(f"(first-pictures/{picture.name})" in text for picture in pictures)
    assert drivora("campaign", "report", failing["campaign"]).out.startswith("# Campaign study-")
    # The service tells and draws the same; commands in its report ask it.
    assert far.read_text().replace(f" --server {url}", "") == text
    assert f"drivora campaign show {failing['campaign']}" in far.read_text()
    drawn = sorted((far.parent / "first-pictures").iterdir())
    assert [picture.name for picture in drawn] == [picture.name for picture in pictures]


def test_what_cannot_be_compared_is_said(drivora: Drivora) -> None:
    drivora("store", "migrate")
    unknown = drivora("campaign", "compare", "nothing")
    assert unknown.code == 2
    assert "unknown campaign 'nothing'" in unknown.err
    measure = drivora("campaign", "compare", "nothing", "--measure", "beauty")
    assert measure.code == 2
    assert "unknown measure 'beauty'; known: avoidable, first_avoidable" in measure.err
    assert drivora("campaign", "report", "nothing").code == 2
