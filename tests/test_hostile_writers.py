"""Every writer of reports with the same hostile names, read by parsers of the formats.

Names with acting characters are refused today; a store may have them from before, and texts of
agents and plug-ins have anything.
"""

from __future__ import annotations

import csv
import io
import json
import logging
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
import structlog
from markdown_it import MarkdownIt
from sqlalchemy import select

from drivora_service.agents.entry import AgentEntry
from drivora_service.benchmarking.card import card_of
from drivora_service.benchmarking.card_text import card_markdown, cards_markdown
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.logs import configure_logs
from drivora_service.oracles.verdicts.failure_definition import KnownFailure
from drivora_service.plotting.charts import chart_style, panels, write_chart
from drivora_service.plotting.picture_file import open_picture
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.studies.comparison.campaign_comparison import Comparison
from drivora_service.studies.comparison.campaign_comparison_text import (
    comparison_markdown as campaigns_markdown,
)
from drivora_service.studies.comparison.campaign_measures import Difference
from drivora_service.studies.comparison.study_comparison import By, OverviewRow, StudyComparison
from drivora_service.studies.comparison.study_comparison_text import study_markdown
from drivora_service.studies.reports.campaign_report import read_report
from drivora_service.studies.reports.campaign_report_text import report_markdown
from drivora_service.studies.tables.csv_text import write_csv
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide
from drivora_service.suites.paired.batch_comparison_files import write_batch_comparison
from drivora_service.suites.paired.batch_comparison_text import comparison_markdown
from drivora_service.suites.paired.batch_pairing import compare_runs
from drivora_service.suites.reports.junit import junit_xml
from drivora_service.suites.reports.markdown_summary import summary_markdown
from drivora_service.suites.reports.report_html import report_html
from drivora_service.suites.reports.runs_csv import runs_csv
from drivora_service.suites.reports.suite_report import SuiteReport, make_report
from drivora_service.suites.suite import SuiteScenario
from tests.benchmarking.made_up_runs import AGENT, finished, violation
from tests.hostile_names import FORMULAS, NAMES, acting_characters
from tests.studies.computed_study import campaign_content, opened
from tests.suites.made_results import DOCUMENT, counted, results_of, suite_run
from tests.suites.paired.samples import batch, run

EVIL = "".join(NAMES)
"""All of them in one."""
_STORED = EVIL.replace("\x00", "")[:200]
"""A name that an earlier version accepted: NUL it never did."""

_MARKDOWN = MarkdownIt("commonmark").enable("table")


class Page(HTMLParser):
    """The elements of a page, with their attributes, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: set[str] = set()
        self.attributes: set[str] = set()
        self.links: list[str] = []
        self.text = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attrs}
        self.links += [value or "" for name, value in attrs if name in {"href", "src"}]

    def handle_data(self, data: str) -> None:
        self.text += data


def assert_harmless_markdown(text: str, *links: str) -> str:
    """Checks a text in Markdown as GitHub would show it; returns its text."""
    assert acting_characters(text) == []
    page = Page(_MARKDOWN.render(text))
    allowed = {"h1", "h2", "h3", "p", "ul", "li", "code", "pre", "strong", "em", "img", "a"}
    allowed |= {"table", "thead", "tbody", "tr", "th", "td"}
    assert page.tags <= allowed
    assert page.attributes <= {"class", "src", "alt", "href", "style"}
    assert set(page.links) <= set(links)
    return page.text


@pytest.fixture(params=[*NAMES, EVIL], ids=[*(ascii(name) for name in NAMES), "all"])
def evil(request: pytest.FixtureRequest) -> str:
    """A hostile name."""
    return str(request.param)


def suite_report(evil: str) -> SuiteReport:
    """Returns a report with a name in all that users, agents and plug-ins write."""
    named, lost = f"a{evil}", f"{evil}b"
    runs = [
        *counted(named, 2, 2),
        suite_run(lost, 0, status=RunStatus.AGENT_FAILED, cause="raised", message=evil),
    ]
    runs = [replace(one, agents={"ego": evil}, configuration=evil) for one in runs]
    results = results_of(runs, suite=evil, agent=evil, agent_parameters=(f"x={evil}",))
    scenarios = {
        name: SuiteScenario(
            name=name,
            document=DOCUMENT,
            tags=(evil,),
            known_failures=(KnownFailure(oracle="collision", reason=evil),),
        )
        for name in results.scenarios
    }
    decision = decide(results, scenarios, GateDocument(), None)
    created = datetime(2026, 1, 2, tzinfo=UTC)
    return make_report(
        results, scenarios, decision, created_at=created, baseline=evil, baseline_subject=evil
    )


def test_reports_of_suites(evil: str) -> None:
    report = suite_report(evil)
    usual = Page(report_html(suite_report("usual")))
    html = report_html(report)
    page = Page(html)
    assert acting_characters(html) == []
    assert page.tags == usual.tags
    assert page.attributes == usual.attributes
    assert page.links == usual.links
    xml = junit_xml(report)
    assert acting_characters(xml.decode()) == []
    cases = ElementTree.fromstring(xml).iter("testcase")
    assert len([case.get("name") for case in cases]) == 3
    assert_harmless_markdown(summary_markdown(report))
    assert_harmless_csv(runs_csv(report))


def assert_harmless_csv(text: str) -> None:
    """Checks that a file of CSV has no formula, and lines of one length."""
    assert acting_characters(text) == []
    rows = list(csv.reader(io.StringIO(text, newline="")))
    assert len({len(row) for row in rows}) == 1
    for cell in (cell for row in rows for cell in row):
        if cell[:1] in set("=+@\uff1d\uff0b\uff0d\uff20"):
            raise AssertionError(cell)
        if cell.startswith("-"):
            float(cell)


def test_tables(evil: str, tmp_path: Path) -> None:
    write_csv(tmp_path / "t.csv", ("name", "value"), [(evil, 1.5), (f" {evil}", -2), (None, None)])
    with (tmp_path / "t.csv").open(newline="") as file:
        assert_harmless_csv(file.read())


@pytest.mark.parametrize("formula", FORMULAS)
def test_formulas_are_marked(formula: str, tmp_path: Path) -> None:
    write_csv(tmp_path / "t.csv", ("name",), [(formula,)])
    with (tmp_path / "t.csv").open(newline="") as file:
        assert list(csv.reader(file))[1] == [f"'{formula}"]


def test_comparisons_of_batches(evil: str, tmp_path: Path) -> None:
    sides = [
        batch([run(f"s{evil}", fails=fails, agent=evil), run("t")], name=evil)
        for fails in ((), ("collision",))
    ]
    comparison = compare_runs(*sides)
    assert_harmless_markdown(comparison_markdown(comparison))
    for file in write_batch_comparison(comparison, tmp_path):
        if file.suffix == ".csv":
            with file.open(newline="") as text:
                assert_harmless_csv(text.read())


def difference(evil: str) -> Difference:
    return Difference(
        measure="failing",
        title=evil,
        larger_is_better=True,
        scenario=evil,
        method=evil,
        baseline=evil,
        repetitions=3,
        baseline_repetitions=3,
        median=1.0,
        baseline_median=1.0,
        a12=0.5,
        low=0.4,
        high=0.6,
        p=1.0,
        p_holm=1.0,
    )


def test_comparisons_of_campaigns_and_studies(evil: str) -> None:
    compared = Comparison(
        baseline=evil,
        budgets={evil: 3},
        time_limits_s={evil: 1.0},
        notes=(evil,),
        differences=(difference(evil),),
        campaigns=(),
    )
    assert_harmless_markdown(campaigns_markdown(compared))
    row = OverviewRow(
        by=By.METHOD,
        measure="failing",
        title=evil,
        larger_is_better=True,
        name=evil,
        baseline=evil,
        median=1.0,
        baseline_median=1.0,
        a12=0.5,
        places=1,
        better=0,
        worse=0,
        undecided=1,
    )
    study = StudyComparison(
        study_id="s",
        name=evil,
        baseline_method=evil,
        baseline_agent=evil,
        time_limits_s={evil: 1.0},
        notes=(evil,),
        overview=(row,),
        by_method=(difference(evil),),
        by_agent=(difference(evil),),
        campaigns=(),
    )
    assert_harmless_markdown(study_markdown(study))


def test_cards_of_agents(evil: str) -> None:
    agent: AgentEntry = replace(AGENT, description=evil, source=evil, licence=evil)
    absent = replace(AGENT, name="absent", reason=evil)
    card = card_of(agent, (finished(1, violation("collision", message=evil)), finished(2)))
    assert_harmless_markdown(card_markdown(card, runs=2, picture="x.svg"), "x.svg")
    assert_harmless_markdown(cards_markdown([card], [absent], runs=2), "made-up.md")


def test_a_campaign_of_an_older_version_is_reported_and_runs(
    catalogues: Catalogues, tmp_path: Path
) -> None:
    """Its name was accepted, and is now in the store."""
    with opened(tmp_path, catalogues) as study:
        record = study.run(campaign_content())
        queued = study.create(campaign_content())
        for stored in (record.id, queued):
            with study.database.write() as transaction:
                session = transaction.session
                row = session.scalars(select(CampaignRow).where(CampaignRow.id == stored)).one()
                row.name = _STORED
                row.document = json.dumps(json.loads(row.document) | {"name": _STORED})
        told = read_report(study.database, record.id, catalogues)
        assert told.record.name == told.document.name == _STORED
        for group in told.groups:
            verdict = group.example.verdict
            object.__setattr__(verdict, "message", EVIL)
        text = report_markdown(told, pictures={told.groups[0].example.evaluation: "x/1.png"})
        shown = assert_harmless_markdown(text, "x/1.png")
        assert "<script>alert(1)</script>" in shown
        assert "\\u001b[31mtext" in shown
        ended = study.continued(queued)
        assert ended.state == "finished"
        assert ended.name == _STORED


@pytest.fixture
def logs_as_before() -> Iterator[None]:
    root = logging.getLogger()
    handlers, level = root.handlers, root.level
    yield
    root.handlers, root.level = handlers, level
    structlog.reset_defaults()


@pytest.mark.usefixtures("logs_as_before")
def test_logs(evil: str, capsys: pytest.CaptureFixture[str]) -> None:
    configure_logs(colors=False)
    log_lines = logging.getLogger("tests")
    log_lines.warning("%s", evil)
    structlog.stdlib.get_logger("tests").warning(evil, name=evil)
    written = capsys.readouterr().err
    assert acting_characters(written) == []
    assert written.count("\n") == 2, written
    try:
        raise ValueError(evil)
    except ValueError:
        log_lines.exception("it failed")
    assert acting_characters(capsys.readouterr().err) == []


@pytest.mark.filterwarnings("ignore:Glyph .* missing from font")
@pytest.mark.filterwarnings("ignore:constrained_layout not applied")
def test_pictures(evil: str, tmp_path: Path) -> None:
    with chart_style():
        figure, (axes,) = panels(1)
        axes.plot([0, 1], [0, 1], label=evil)
        axes.set_title(evil)
        axes.legend()
        svg, _ = write_chart(figure, tmp_path / "chart")
    with open_picture(tmp_path / "picture.svg", width_in=3, height_in=2) as figure:
        figure.text(0.1, 0.5, evil)
    for file in (svg, tmp_path / "picture.svg"):
        text = file.read_text()
        assert acting_characters(text) == []
        tags = {element.tag.rpartition("}")[2] for element in ElementTree.fromstring(text).iter()}
        assert "script" not in tags
