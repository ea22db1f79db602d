"""Stored campaigns against one another."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.search.failure_grouping import Grouping
from drivora_service.errors import CampaignError, UnknownName
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.store.campaigns.campaign_records import CampaignRecord, Confirmation
from drivora_service.studies.accountable_counts import accountable_rows
from drivora_service.studies.campaign_lookup import choose_campaigns
from drivora_service.studies.comparison.campaign_comparison import compare_stored
from drivora_service.studies.comparison.campaign_comparison_files import write_comparison
from drivora_service.studies.comparison.campaign_comparison_text import (
    comparison_markdown,
    methods_of,
)
from drivora_service.studies.comparison.campaign_measures import MEASURES, measure
from drivora_service.studies.reports.campaign_report import read_report
from tests.studies.computed_study import Study, campaign_content, opened

METHODS: dict[str, dict[str, Any]] = {
    "random": {"name": "random"},
    "avfuzzer": {"name": "avfuzzer"},
    "twin": {"name": "avfuzzer", "feedback": "shuffled"},
}


@pytest.fixture(scope="module")
def finished(catalogues: Catalogues, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with three repetitions of each method; to be copied, not to be changed."""
    folder = tmp_path_factory.mktemp("study")
    content = campaign_content() | {"budget": {"simulations": 14}}
    with opened(folder, catalogues) as study:
        for method, tester in METHODS.items():
            for seed in (1, 2, 3):
                study.run(content, name=f"study-{method}-{seed}", tester=tester, seed=seed)
    return folder


@pytest.fixture
def study(finished: Path, catalogues: Catalogues, tmp_path: Path) -> Iterator[Study]:
    shutil.copytree(finished, tmp_path / "data")
    with opened(tmp_path / "data", catalogues) as study:
        yield study


@pytest.fixture
def records(study: Study) -> tuple[CampaignRecord, ...]:
    return choose_campaigns(study.database, ["study-*"])


def test_campaigns_are_counted_and_compared(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    comparison = compare_stored(study.database, records, study.catalogues)
    assert [f.campaign for f in comparison.campaigns] == [record.id for record in records]
    assert {f.method for f in comparison.campaigns} == {
        "random",
        "avfuzzer",
        "avfuzzer without feedback",
    }
    for record, figures in zip(records, comparison.campaigns, strict=True):
        assert figures.simulations == 14
        assert figures.failing == record.counts.violating > 0
        assert figures.groups is not None
        assert 0 < figures.groups <= figures.failing
        assert figures.network_coverage is not None
        assert 0.0 < figures.network_coverage < 1.0
        assert 0.0 < figures.gene_coverage < 1.0
        assert figures.law_coverage is None, "no law judged these runs"
    # Two methods against the baseline; seconds to the first failure, too: all found one. Random
    # has no mutants, and laws were not judged.
    assert len(comparison.differences) == 2 * (len(MEASURES) - 2)
    assert comparison.budgets == {"tee-town": 14}
    assert {figures.budget for figures in comparison.campaigns} == {14}
    assert comparison.time_limits_s == {}
    assert comparison.notes == ()


def test_failures_that_did_not_happen_again_do_not_count(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    before = compare_stored(study.database, records, study.catalogues).campaigns[0]
    journal = StoreJournal(study.database, records[0].id)
    first = journal.failures()[0].evaluation
    journal.confirm(first, Confirmation.FLAKY, "")
    after = compare_stored(study.database, records, study.catalogues).campaigns[0]
    assert after.failing == before.failing - 1
    assert after.first_failure is not None
    assert before.first_failure is not None
    assert after.first_failure > before.first_failure


def test_a_baseline_that_never_fails_is_noted(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    for record in records:
        if record.tester == "random":
            journal = StoreJournal(study.database, record.id)
            for number in {failure.evaluation for failure in journal.failures()}:
                journal.confirm(number, Confirmation.FLAKY, "")
    comparison = compare_stored(study.database, records, study.catalogues)
    (note,) = comparison.notes
    assert note.startswith("tee-town: random fails in 0 of 42 simulations")
    assert f"- Note: {note}" in comparison_markdown(comparison)


def test_at_equal_time_the_shortest_campaign_says_how_long(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    comparison = compare_stored(study.database, records, study.catalogues, equal_time=True)
    limit = comparison.time_limits_s["tee-town"]
    made = [f.simulations for f in comparison.campaigns]
    assert max(made) == 14
    assert min(made) < 14
    assert all(f.simulation_s + f.own_s <= limit * (1.0 + 1e-9) for f in comparison.campaigns)
    names = {row.measure for row in comparison.differences}
    assert "first_failure_s" in names
    assert "first_failure" not in names


def test_the_figures_of_a_campaign_do_not_depend_on_the_others(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    whole = compare_stored(study.database, records, study.catalogues)
    alone = {figures.campaign: figures for figures in whole.campaigns}
    by_method = [records[start : start + 3] for start in (0, 3, 6)]
    random = np.random.default_rng(3)
    for _ in range(8):
        methods = [0, *random.permutation([1, 2])[: random.integers(1, 3)].tolist()]
        chosen = [
            by_method[method][repetition]
            for method in methods
            for repetition in random.permutation(3)[: random.integers(2, 4)].tolist()
        ]
        some = compare_stored(study.database, chosen, study.catalogues)
        assert len(some.campaigns) == len(chosen)
        for figures in some.campaigns:
            # Names tell methods apart, and differ with what there is to tell apart.
            own = alone[figures.campaign]
            assert replace(figures, method=own.method, scenario=own.scenario) == own
    # And the report of a campaign, which compares with nothing, counts the same.
    for record in records:
        report = read_report(study.database, record.id, study.catalogues)
        assert report.figures is not None
        own = alone[record.id]
        named = replace(report.figures, method=own.method, scenario=own.scenario)
        assert replace(named, groups=own.groups) == own


def test_groups_are_made_of_the_failures_of_one_campaign() -> None:
    def at(*places: float) -> list[Verdict]:
        return [
            Verdict(
                oracle="collision",
                ego="ego",
                outcome=Outcome.VIOLATED,
                message="",
                location=(place, 0.0),
            )
            for place in places
        ]

    grouping = Grouping()
    assert grouping.count([]) == 0
    assert grouping.count(at(0.0, 1.0)) == 2
    # On the scale of these a metre is little.
    assert grouping.count(at(0.0, 1.0, 100.0)) == 2


def test_what_counts_and_what_does_not_are_told_apart(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    comparison = compare_stored(study.database, records, study.catalogues)
    rows = accountable_rows(comparison.campaigns)
    methods = methods_of(comparison.campaigns)
    assert [row[:2] for row in rows] == [("tee-town", method) for method in methods]
    assert [int(row[2]) for row in rows] == [3 * 14] * 3
    for row, start in zip(rows, (0, 3, 6), strict=True):
        own = comparison.campaigns[start : start + 3]
        assert int(row[3]) == sum(f.avoidable for f in own)
        assert int(row[-1]) == sum(f.not_at_fault for f in own)
    text = comparison_markdown(comparison)
    assert f"| {' | '.join(rows[0])} |" in text
    assert "(Mann-Whitney U, two-sided)" in text


def test_campaigns_of_another_version_are_refused(
    study: Study, records: tuple[CampaignRecord, ...]
) -> None:
    journal = StoreJournal(study.database, records[0].id)
    first = next(journal.evaluations())
    values = first.proposal.values.tolist()
    with study.database.write() as transaction:
        connection = transaction.session.connection()
        connection.exec_driver_sql(
            "UPDATE evaluations SET genes = ? WHERE number = 0 AND campaign_seq = "
            "(SELECT seq FROM campaigns WHERE id = ?)",
            (json.dumps(values[:-1]), records[0].id),
        )
    with pytest.raises(CampaignError, match="other genes"):
        compare_stored(study.database, records, study.catalogues)


def test_files_say_what_the_comparison_says(
    study: Study, records: tuple[CampaignRecord, ...], tmp_path: Path
) -> None:
    chosen = [measure("at_fault"), measure("kinds")]
    comparison = compare_stored(study.database, records, study.catalogues, measures=chosen)
    files = write_comparison(comparison, tmp_path / "out")
    assert all(path.stat().st_size > 0 for path in files)
    assert {path.suffix for path in files} == {".md", ".csv", ".svg", ".png"}
    with (tmp_path / "out" / "comparison.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["a12"]) for row in rows] == [row.a12 for row in comparison.differences]
    with (tmp_path / "out" / "figures.csv").open() as file:
        figures = list(csv.DictReader(file))
    assert [row["campaign"] for row in figures] == [record.id for record in records]
    assert figures[0]["found"].split() == [str(n) for n in comparison.campaigns[0].found]
    text = comparison_markdown(comparison)
    assert text in (tmp_path / "out" / "comparison.md").read_text()
    assert len(comparison.differences) == 4
    # And a row a method of what the simulations came to.
    assert text.count("| tee-town |") == 4 + 3
    with (tmp_path / "out" / "survival.csv").open() as file:
        survival = list(csv.DictReader(file))
    assert [(row["method"], row["events"]) for row in survival if row["k"] == "1"] == [
        (
            method,
            str(sum(bool(f.found_avoidable) for f in comparison.campaigns if f.method == method)),
        )
        for method in methods_of(comparison.campaigns)
    ]
    assert "![survival-1.svg](survival-1.svg)" in (tmp_path / "out" / "comparison.md").read_text()
    again = write_comparison(comparison, tmp_path / "again")
    assert [p.read_bytes() for p in again] == [p.read_bytes() for p in files]


def test_campaigns_are_chosen_by_id_name_and_pattern(
    catalogues: Catalogues, tmp_path: Path
) -> None:
    content = campaign_content()
    names = ("study-a", "study-b", "other", "study-a")
    with opened(tmp_path, catalogues) as study:
        ids = [study.create(content, name=name, seed=n) for n, name in enumerate(names)]
        _check_choice(study, ids)


def _check_choice(study: Study, ids: list[str]) -> None:

    def chosen(*wanted: str) -> list[str]:
        return [record.id for record in choose_campaigns(study.database, wanted)]

    assert chosen(ids[2], ids[0]) == [ids[0], ids[2]]
    assert chosen("study-a") == [ids[0], ids[3]]
    assert chosen("study-*", ids[1]) == [ids[0], ids[1], ids[3]]
    with pytest.raises(UnknownName, match="Known: study-a, other, study-b"):
        chosen("study-*", "stud-*")
