"""A finished study compared by method and by agent, and as tables."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.errors import Conflict, UnknownName
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.database import Database, open_database
from drivora_service.studies.comparison.campaign_measures import measure
from drivora_service.studies.comparison.study_comparison import (
    HEADLINES,
    By,
    StudyComparison,
    compare_study,
)
from drivora_service.studies.comparison.study_comparison_files import write_study_comparison
from drivora_service.studies.comparison.study_comparison_text import study_markdown
from drivora_service.studies.comparison.survival_curves import kinds_reached
from drivora_service.studies.table_names import TableName
from drivora_service.studies.tables.study_tables import SCHEMAS, csv_chunks, parquet_chunks
from tests.studies.example_study import run_computed, stored


@pytest.fixture(scope="module")
def database(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    database = open_database(f"sqlite:///{tmp_path_factory.mktemp('study') / 'drivora.sqlite3'}")
    yield database
    database.close()


@pytest.fixture(scope="module")
def study_id(
    database: Database, catalogues: Catalogues, tmp_path_factory: pytest.TempPathFactory
) -> str:
    """A study whose campaigns have finished, with computed runs."""
    root = tmp_path_factory.mktemp("folders")
    study_id = stored(database, catalogues, root)
    run_computed(database, catalogues, root, study_id)
    return study_id


@pytest.fixture(scope="module")
def comparison(database: Database, study_id: str, catalogues: Catalogues) -> StudyComparison:
    return compare_study(database, study_id, catalogues)


def test_methods_and_agents_are_compared_at_every_place(comparison: StudyComparison) -> None:
    assert (comparison.baseline_method, comparison.baseline_agent) == ("random", "idm")
    assert len(comparison.campaigns) == 16
    places = {(row.scenario, row.method) for row in comparison.by_method}
    assert places == {
        (f"{scenario}, {agent}", "fuzzer")
        for scenario in ("first", "second")
        for agent in ("idm", "idm-mobil")
    }
    assert {(row.scenario, row.method) for row in comparison.by_agent} == {
        (f"{scenario}, {method}", "idm-mobil")
        for scenario in ("first", "second")
        for method in ("random", "fuzzer")
    }
    assert {row.measure for row in comparison.by_method} == set(HEADLINES)
    assert {row.repetitions for row in comparison.by_method} == {2}


def test_baselines_that_fail_too_often_are_noted(comparison: StudyComparison) -> None:
    noted = set()
    for scenario, agent in {(f.scenario, f.agent) for f in comparison.campaigns}:
        own = [
            f
            for f in comparison.campaigns
            if (f.scenario, f.agent, f.method) == (scenario, agent, "random")
        ]
        rate = sum(f.failing for f in own) / sum(f.simulations for f in own)
        if not 0.005 <= rate <= 0.5:
            noted.add(f"{scenario}, {agent}")
    assert {note.partition(":")[0] for note in comparison.notes} == noted


def test_the_overview_counts_the_places(comparison: StudyComparison) -> None:
    assert {(row.by, row.name, row.baseline) for row in comparison.overview} == {
        (By.METHOD, "fuzzer", "random"),
        (By.AGENT, "idm-mobil", "idm"),
    }
    for row in comparison.overview:
        assert row.better + row.worse + row.undecided == row.places == 4
        assert 0.0 <= row.a12 <= 1.0
    by_method = {row.measure: row for row in comparison.overview if row.by is By.METHOD}
    same = [row for row in comparison.by_method if row.measure == "failing"]
    assert by_method["failing"].a12 == pytest.approx(sum(row.a12 for row in same) / 4)
    failing = sorted(f.failing for f in comparison.campaigns if f.method == "fuzzer")
    assert by_method["failing"].median == (failing[3] + failing[4]) / 2
    # Computed runs do not depend on the agent.
    assert {row.a12 for row in comparison.overview if row.by is By.AGENT} == {0.5}


def test_baselines_and_measures_can_be_chosen(
    database: Database, study_id: str, catalogues: Catalogues
) -> None:
    chosen = compare_study(
        database,
        study_id,
        catalogues,
        baseline_method="fuzzer",
        baseline_agent="idm-mobil",
        measures=[measure("kinds")],
    )
    assert {row.name for row in chosen.overview} == {"random", "idm"}
    assert {row.measure for row in chosen.overview} == {"kinds"}
    with pytest.raises(UnknownName, match="Known: random, fuzzer"):
        compare_study(database, study_id, catalogues, baseline_method="avfuzzer")


def test_campaigns_that_have_not_finished_are_left_out(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    with pytest.raises(Conflict, match="0 of 16 campaigns have finished"):
        compare_study(database, study_id, catalogues)
    with database.write() as transaction:
        for campaign_id in transaction.studies.campaign_ids(study_id)[8:]:
            transaction.campaigns.end(campaign_id, CampaignState.CANCELLED)
    with pytest.raises(Conflict, match="nothing to compare"):
        compare_study(database, study_id, catalogues)


def test_at_equal_time_methods_are_compared_within_the_shortest_campaign_of_a_place(
    database: Database, study_id: str, catalogues: Catalogues, comparison: StudyComparison
) -> None:
    limited = compare_study(database, study_id, catalogues, equal_time=True)
    limits = {
        f"{scenario}, {agent}": min(
            one.own_s + one.simulation_s
            for one in comparison.campaigns
            if (one.scenario, one.agent) == (scenario, agent)
        )
        for scenario in ("first", "second")
        for agent in ("idm", "idm-mobil")
    }
    assert limited.time_limits_s == pytest.approx(limits)
    assert comparison.time_limits_s == {}
    # Time is the agent's: no comparison by agent.
    assert limited.by_agent == () != comparison.by_agent
    whole = {one.campaign: one.simulations for one in comparison.campaigns}
    left = [whole[one.campaign] - one.simulations for one in limited.campaigns]
    assert min(left) == 0 < max(left)
    for one in limited.campaigns:
        assert one.own_s + one.simulation_s <= limits[f"{one.scenario}, {one.agent}"] + 1e-6
    text = study_markdown(limited)
    assert f"after {limits['first, idm']:.1f} s of one worker" in text
    assert "agents with" not in text


def test_the_files_have_the_overview_first_and_charts(
    comparison: StudyComparison, tmp_path: Path
) -> None:
    written = write_study_comparison(comparison, tmp_path / "out")
    kinds = kinds_reached(comparison.campaigns)
    assert {path.name for path in written} == {
        *(f"survival-{k}.{suffix}" for k in kinds for suffix in ("svg", "png")),
        "survival.csv",
        "study.md",
        "by-method.csv",
        "by-agent.csv",
        "figures.csv",
        "values.svg",
        "values.png",
    }
    text = (tmp_path / "out" / "study.md").read_text()
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings[:3] == [
        "## By method, against random",
        "## By agent, against idm",
        "## What the simulations came to",
    ]
    assert headings[-1] == "## Simulations to the first kinds"
    assert len(headings) == 3 + 2 * len(HEADLINES) + 1
    with (tmp_path / "out" / "survival.csv").open(newline="") as file:
        survival = list(csv.DictReader(file))
    # Two scenarios, two agents and two methods, each with two repetitions.
    assert len(survival) == 8 * len(kinds)
    for row in survival:
        own = [
            f.found_avoidable
            for f in comparison.campaigns
            if (f.scenario, f.agent, f.method) == (row["scenario"], row["agent"], row["method"])
        ]
        reached = sorted(found[int(row["k"]) - 1] for found in own if len(found) >= int(row["k"]))
        assert (int(row["repetitions"]), int(row["events"])) == (2, len(reached))
        assert row["median"] == (str(reached[0]) if reached else "")
    figures = (tmp_path / "out" / "figures.csv").read_text()
    rows = list(csv.DictReader(io.StringIO(figures)))
    assert {row["agent"] for row in rows} == {"idm", "idm-mobil"}
    assert (tmp_path / "out" / "values.png").stat().st_size > 10_000


def test_tables_hold_everything_in_both_forms(
    database: Database, study_id: str, comparison: StudyComparison, tmp_path: Path
) -> None:
    for name in TableName:
        path = tmp_path / f"{name}.parquet"
        path.write_bytes(b"".join(parquet_chunks(database, study_id, name)))
        table = pq.read_table(path)
        assert table.schema.equals(SCHEMAS[name])
        text = b"".join(csv_chunks(database, study_id, name)).decode()
        lines = list(csv.DictReader(io.StringIO(text)))
        assert len(lines) == table.num_rows > 0
        for line, row in zip(lines, table.to_pylist(), strict=True):
            assert line.keys() == row.keys()
            assert (line["campaign_id"], line["method"]) == (row["campaign_id"], row["method"])
            assert int(line["seed"]) == row["seed"] == 2 + row["repetition"]
    evaluations = pq.read_table(tmp_path / "evaluations.parquet").to_pylist()
    failures = pq.read_table(tmp_path / "failures.parquet").to_pylist()
    for figures in comparison.campaigns:
        own = [row for row in evaluations if row["campaign_id"] == figures.campaign]
        assert [row["evaluation"] for row in own] == list(range(len(own)))
        assert sum(row["violations"] > 0 for row in own) == figures.failing
        assert sum(row["status"] != "invalid" for row in own) == figures.simulations
        found = {row["evaluation"] for row in failures if row["campaign_id"] == figures.campaign}
        assert len(found) == figures.failing
    assert {row["confirmation"] for row in failures} == {"confirmed"}
    assert "min_gap" in json.loads(evaluations[0]["objectives"])
    assert len(evaluations[0]["genes"]) > 10


def test_pandas_reads_the_tables_with_their_types(
    database: Database, study_id: str, comparison: StudyComparison, tmp_path: Path
) -> None:
    read = {}
    for name in TableName:
        path = tmp_path / f"{name}.parquet"
        path.write_bytes(b"".join(parquet_chunks(database, study_id, name)))
        read[name] = pd.read_parquet(path)
        assert list(read[name].columns) == SCHEMAS[name].names
    evaluations, failures = read[TableName.EVALUATIONS], read[TableName.FAILURES]
    assert (evaluations["seed"].dtype, evaluations["violations"].dtype) == ("int64", "int32")
    assert evaluations["at_fault"].dtype == bool
    failing = evaluations[evaluations["violations"] > 0].groupby("method").size()
    for method in ("random", "fuzzer"):
        own = [figures.failing for figures in comparison.campaigns if figures.method == method]
        assert failing[method] == sum(own) > 0
    keys = ["campaign_id", "evaluation"]
    joined = failures.merge(evaluations, on=keys, validate="many_to_one")
    assert len(joined) == len(failures)
    assert (joined["violations"] > 0).all()


def test_the_comparison_can_be_computed_again_from_the_tables_alone(
    database: Database, study_id: str, comparison: StudyComparison, tmp_path: Path
) -> None:
    """By other code, from the exported files: nothing that is compared is lost."""
    read = {}
    for name in TableName:
        path = tmp_path / f"{name}.parquet"
        path.write_bytes(b"".join(parquet_chunks(database, study_id, name)))
        read[name] = pd.read_parquet(path)
    for figures in comparison.campaigns:
        runs, failures = (
            read[name][read[name]["campaign_id"] == figures.campaign]
            for name in (TableName.EVALUATIONS, TableName.FAILURES)
        )
        simulated = (runs["status"] != "invalid").cumsum()
        simulation = dict(zip(runs["evaluation"], simulated, strict=True))
        targets = failures[
            failures["at_fault"].fillna(value=False).astype(bool)
            & (failures["avoidable"].isna() | (failures["avoidable"] == "yes"))
        ]
        assert (targets["accountability"] == "avoidable").all()
        for chosen, count, kinds, situations, first in (
            (
                targets,
                figures.avoidable,
                figures.avoidable_kinds,
                figures.avoidable_situations,
                figures.first_avoidable,
            ),
            (
                failures,
                figures.failing,
                figures.kinds,
                figures.situations,
                figures.first_failure,
            ),
        ):
            assert chosen["evaluation"].nunique() == count
            assert chosen["kind"].nunique() == kinds
            speeds = [json.loads(text) for text in chosen["evidence"]]
            cells = {
                (row.kind, row.x // 10.0, row.y // 10.0, evidence.get("ego_speed", -9.0) // 5.0)
                for row, evidence in zip(chosen.itertuples(), speeds, strict=True)
            }
            assert len(cells) == situations
            earliest = chosen["evaluation"].min()
            assert (simulation[earliest] if len(chosen) else None) == first
        others = (runs["violations"] == 0) & (runs["not_at_fault"] > 0)
        assert others.sum() == figures.not_at_fault
        drawn = runs["redrawn"].sum() + (runs["parents"].map(len) > 0).sum()
        assert figures.redrawn_share == (runs["redrawn"].sum() / drawn if drawn else None)
    assert sum(figures.not_at_fault for figures in comparison.campaigns) > 0
    assert sum(figures.avoidable for figures in comparison.campaigns) > 0


def test_an_unknown_study_has_no_table(database: Database) -> None:
    with pytest.raises(UnknownName):
        b"".join(csv_chunks(database, "0123", TableName.FAILURES))
