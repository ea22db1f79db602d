"""The report of one campaign."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.store.campaigns.campaign_records import Confirmation, Failure
from drivora_service.studies.reports.campaign_report import group, read_report
from drivora_service.studies.reports.campaign_report_pictures import draw_examples
from drivora_service.studies.reports.campaign_report_text import report_markdown
from tests.studies.computed_study import Study, campaign_content, opened


@pytest.fixture
def study(catalogues: Catalogues, tmp_path: Path) -> Iterator[Study]:
    with opened(tmp_path, catalogues) as study:
        yield study


def failure(number: int, kind: str, group: int | None, **changes: object) -> Failure:
    verdict = Verdict(
        oracle=kind.partition("|")[0],
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="",
        at_fault=True,
    )
    fields: dict[str, object] = {
        "evaluation": number,
        "place": 0,
        "kind": kind,
        "verdict": verdict,
        "group": group,
    }
    return Failure(**(fields | changes))  # type: ignore[arg-type] # the test names the fields


def test_failures_are_collected_by_kind_and_group() -> None:
    confirmed = {"confirmation": Confirmation.CONFIRMED, "trace": "5.parquet"}
    groups = group(
        [
            failure(2, "collision|a", 0),
            failure(3, "collision|b", 0),
            failure(4, "collision|a", 1),
            failure(5, "collision|a", 0, **confirmed),
            failure(6, "collision|a", 0, confirmation=Confirmation.FLAKY),
        ]
    )
    assert [(g.kind, g.number, [f.evaluation for f in g.failures]) for g in groups] == [
        ("collision|a", 0, [2, 5, 6]),
        ("collision|b", 0, [3]),
        ("collision|a", 1, [4]),
    ]
    assert groups[0].example.evaluation == 5
    assert groups[1].example.evaluation == 3
    assert groups[0].count(Confirmation.CONFIRMED) == groups[0].count(Confirmation.FLAKY) == 1
    assert groups[0].at_fault == 3


def test_the_report_tells_counts_groups_and_commands(study: Study) -> None:
    tester = {"name": "avfuzzer", "parameters": {"population": 6}, "feedback": "shuffled"}
    record = study.run(campaign_content(), tester=tester)
    told = read_report(study.database, record.id, study.catalogues)
    assert told.privileged == ()
    text = report_markdown(told, pictures={told.groups[0].example.evaluation: "x/1.png"})
    assert f"| simulations | {record.counts.simulations} of 12 |" in text
    assert f"| simulations with a failure | {record.counts.violating} |" in text
    assert '| its parameters | {"population": 6} |' in text
    assert "the results of other candidates" in text
    assert "% of the drivable lanes" in text
    assert "![Evaluation " in text
    for one in told.groups:
        number = one.example.evaluation
        assert f"drivora campaign scenario {record.id} {number} --out" in text
    assert text.count("### ") == len(told.groups) > 0
    numbers = {f.evaluation for f in StoreJournal(study.database, record.id).failures()}
    assert {f.evaluation for one in told.groups for f in one.failures} == numbers


def test_a_campaign_that_found_nothing_has_no_group_of_failures(study: Study) -> None:
    record = study.run(campaign_content(), oracles=["deadlock"])
    told = read_report(study.database, record.id, study.catalogues)
    assert told.groups == ()
    assert told.figures is not None
    assert (told.figures.groups, told.figures.budget) == (0, 12)
    text = report_markdown(told)
    assert "| groups of similar failures | 0 |" in text
    assert "## Warnings\n\n- No failure in 12 simulations: if they were drawn at random, at" in text
    assert "See `docs/how-to/when-everything-or-nothing-fails.md#nothing-fails`." in text
    assert "| seed scenarios as they are, outside the budget | 0 of 1 fail |" in text


def test_a_campaign_that_has_not_begun_has_a_report(study: Study) -> None:
    campaign_id = study.create(campaign_content())
    told = read_report(study.database, campaign_id, study.catalogues)
    text = report_markdown(told)
    assert "queued" in text
    assert "No failures were found." in text
    assert told.figures is not None
    assert told.figures.network_coverage is None
    assert told.figures.groups is None


def test_what_cannot_be_known_any_more_is_said(study: Study) -> None:
    record = study.run(campaign_content())
    with study.database.write() as transaction:
        transaction.session.connection().exec_driver_sql(
            "UPDATE campaigns SET network_sha256 = 'other'"
        )
    told = read_report(study.database, record.id, study.catalogues)
    assert told.figures is None
    text = report_markdown(told)
    assert "road network 'tee-town' has changed" in text
    assert f"| simulations with a failure | {record.counts.violating} |" in text


def test_without_traces_nothing_is_drawn(study: Study, tmp_path: Path) -> None:
    record = study.run(campaign_content())
    told = read_report(study.database, record.id, study.catalogues)
    pictures = draw_examples(told, tmp_path / "none", study.catalogues, tmp_path / "pictures")
    assert pictures == {}
    assert not (tmp_path / "pictures").exists()


def test_an_ads_that_sees_everything_is_marked(study: Study) -> None:
    record = study.run({**campaign_content(), "agent": {"name": "sumo-krauss"}})
    told = read_report(study.database, record.id, study.catalogues)
    (ego,) = told.privileged
    assert f"| egos with full observations | {ego} |" in report_markdown(told)
