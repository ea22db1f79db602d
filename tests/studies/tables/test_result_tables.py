"""The tables of results, read by other code and compared with what the database holds."""

from __future__ import annotations

import csv
import io
import json
import math
import sqlite3
import tracemalloc
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from benchmarks.million_fill import fill_runs
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.errors import UnknownName
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    KnownFailure,
    definition_to_json,
)
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.database import open_database
from drivora_service.store.runs.result_records import ResultFilter
from drivora_service.store.runs.run_records import JobFilter, RunOptions
from drivora_service.studies.table_names import ResultTableName, TableForm
from drivora_service.studies.tables import result_tables, table_forms
from drivora_service.studies.tables.result_table_columns import COLUMNS
from drivora_service.studies.tables.result_tables import result_table
from drivora_service.studies.tables.table_forms import table_chunks
from tests.store.samples import claim, ended, finish, new_run, register
from tests.studies.result_world import ODD_LABELS, ODD_NUMBERS, World, held, result_world

Row = dict[str, Any]
EVERYTHING = ResultFilter()


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory, catalogues: Catalogues) -> Iterator[World]:
    folder = tmp_path_factory.mktemp("world")
    with result_world(folder, catalogues) as filled:
        yield filled


@pytest.fixture(scope="module")
def runs(world: World) -> dict[str, Row]:
    return held(world.file)


def frame(world: World, name: ResultTableName, wanted: ResultFilter = EVERYTHING) -> pd.DataFrame:
    """A table as pandas reads it from Parquet."""
    content = b"".join(table_chunks(result_table(world.database, name, wanted), TableForm.PARQUET))
    return pd.read_parquet(io.BytesIO(content), dtype_backend="numpy_nullable")


def lines(world: World, name: ResultTableName) -> list[dict[str, str]]:
    """A table as Python reads it from CSV."""
    content = b"".join(table_chunks(result_table(world.database, name, EVERYTHING), TableForm.CSV))
    return list(csv.DictReader(io.StringIO(content.decode(), newline="")))


def ids(world: World, wanted: ResultFilter) -> list[str]:
    found: list[str] = frame(world, ResultTableName.RUNS, wanted)["run_id"].tolist()
    return found


def plain(value: Any) -> Any:
    return None if value is pd.NA or value is pd.NaT or value is None else value


def records(table: pd.DataFrame) -> list[Row]:
    return [
        {str(name): plain(value) for name, value in row.items()}
        for row in table.to_dict(orient="records")
    ]


def test_every_run_is_in_the_table_once(world: World, runs: dict[str, Row]) -> None:
    found = records(frame(world, ResultTableName.RUNS))
    assert [row["run_id"] for row in found] == list(runs)
    assert {row["source"] for row in found} == {"run", "evaluation"}
    for row in found:
        run = runs[row["run_id"]]
        report = run["report"]
        for name in ("source", "campaign_id", "campaign", "agent", "status", "item"):
            assert row[name] == run[name], name
        assert row["study_id"] == (run["study_id"] or None)
        shown = "" if run["batch_id"].startswith("jobs") else run["batch_id"]
        assert (row["batch_id"] or "") == shown
        assert row["trace_sha256"] == (report.get("trace_sha256") or None)
        assert row["error"] == (report.get("failure") or {}).get("message")
        is_finished = run["status"] == "finished"
        assert row["steps"] == (report["steps"] if is_finished else None)
        assert row["wall_time_s"] == (report["wall_time_s"] if is_finished else None)
        violated = [
            verdict
            for verdict in report.get("verdicts", ())
            if verdict["outcome"] == "violated" and verdict["severity"] != "observation"
        ]
        assert row["violations"] == (len(violated) if is_finished else None)
        at_fault = sum(verdict["at_fault"] is True for verdict in violated)
        assert row["at_fault_violations"] == (at_fault if is_finished else None)


def test_the_places_of_runs(world: World, runs: dict[str, Row]) -> None:
    by_id = {row["run_id"]: row for row in records(frame(world, ResultTableName.RUNS))}
    served = [row for row in by_id.values() if row["campaign_id"] == world.served]
    assert [row["source"] for row in served] == [*["run"] * 4, *["evaluation"] * (len(served) - 4)]
    assert [row["evaluation"] for row in served] == [0, 1, 2, 0, *range(3, len(served) - 1)]
    assert [row["run_id"] for row in served if row["confirms"]] == [f"{world.served}-0-again"]
    of_study = [row for row in by_id.values() if row["study_id"] == world.study]
    assert {row["study_method"] for row in of_study} == {"random", "fuzzer"}
    assert {row["study_scenario"] for row in of_study} == {"first"}
    assert {(row["study_agent"], row["repetition"]) for row in of_study} == {("idm", 1)}
    assert by_id[world.single]["seed"] == 77
    for row in by_id.values():
        if row["run_id"] != world.single:
            assert row["seed"] == runs[row["run_id"]]["document"].get("seed")
    labels = [row["label"] for row in by_id.values() if row["batch_id"] == world.batch]
    assert labels == list(ODD_LABELS)
    first = next(row for row in by_id.values() if row["label"] == ODD_LABELS[0])
    assert (first["drivora_version"], first["sumo_version"]) == ("0.1.0", "1.28.0")
    assert json.loads(first["versions"])["numpy"] == "2.4"
    assert (first["step_cost_us"], first["accountability"]) == (12.5, "unavoidable")


def test_times_are_those_of_the_database(world: World, runs: dict[str, Row]) -> None:
    table = frame(world, ResultTableName.RUNS)
    assert str(table["created_at"].dtype) == "datetime64[us, UTC]"
    for row in records(table):
        if row["source"] == "run":
            for name in ("created_at", "started_at", "ended_at"):
                stored = runs[row["run_id"]][name]
                assert row[name] == (stored and pd.Timestamp(stored, tz="UTC").to_pydatetime())


def test_verdicts_are_those_of_the_reports(world: World, runs: dict[str, Row]) -> None:
    found = iter(records(frame(world, ResultTableName.VERDICTS)))
    for run_id, run in runs.items():
        for place, verdict in enumerate(run["report"].get("verdicts", ())):
            row = next(found)
            assert (row["run_id"], row["place"]) == (run_id, place)
            for name in ("oracle", "ego", "outcome", "at_fault", "undetermined", "step"):
                assert row[name] == verdict[name], name
            for name in ("avoidable", "physically_avoidable"):
                assert row[name] == verdict[name], name
            assert row["time_s"] == verdict["time"]
            assert [row["x"], row["y"]] == (verdict["location"] or [None, None])
            assert row["message"] == (verdict["message"] or None)
            assert row["counterpart"] == (verdict["counterpart"] or None)
            assert json.loads(row["evidence"]) == verdict["evidence"]
            is_violated = verdict["outcome"] == "violated"
            assert row["severity"] == (verdict["severity"] if is_violated else None)
            assert row["accountability"] == (accountable(verdict) if is_violated else None)
    assert next(found, None) is None


def test_tables_say_what_their_failures_are(tmp_path: Path) -> None:
    """Of runs with verdicts of which each definition counts others."""
    database = open_database(f"sqlite:///{tmp_path}/drivora.sqlite3")
    known = KnownFailure(oracle="red_light", agents=("idm",))
    definitions = (
        FailureDefinition(),
        FailureDefinition(counts=Counted.ANY, known=(known,)),
        FailureDefinition(oracles=("destination", "near_miss")),
    )
    violated = Verdict(
        oracle="collision", ego="ego", outcome=Outcome.VIOLATED, message="", at_fault=True
    )
    verdicts = (
        replace(violated, outcome=Outcome.PASSED),
        violated,
        replace(violated, oracle="near_miss", severity=Severity.OBSERVATION),
        replace(violated, oracle="destination", follows="collision"),
        replace(violated, oracle="red_light", at_fault=False),
    )
    with database.write() as transaction:
        options = [RunOptions(definition=definition_to_json(one)) for one in definitions]
        ids = transaction.jobs.submit([new_run("{}", options=one) for one in options])
    owner = register(database)
    claim(database, owner, len(ids))
    agents = {"ego": AgentChoice(name="idm")}
    for run_id in ids:
        report = RunReport(
            run_id=run_id, status=RunStatus.FINISHED, verdicts=verdicts, agents=agents
        )
        finish(database, owner, ended(report))

    def table(name: ResultTableName) -> list[Row]:
        content = table_chunks(result_table(database, name, EVERYTHING), TableForm.JSON)
        columns: dict[str, list[Any]] = json.loads(b"".join(content))["columns"]
        rows = zip(*columns.values(), strict=True)
        return [dict(zip(columns, row, strict=True)) for row in rows]

    runs = {row["run_id"]: row for row in table(ResultTableName.RUNS)}
    assert [(runs[one]["failures"], runs[one]["counts"], runs[one]["oracles"]) for one in ids] == [
        (1, "accountable", None),
        (1, "any", None),
        (2, "accountable", "destination,near_miss"),
    ]
    found = table(ResultTableName.VERDICTS)
    counted = [[row["counted"] for row in found if row["run_id"] == one] for one in ids]
    assert counted == [
        [None, True, False, False, False],
        [None, True, False, False, False],
        [None, False, True, True, False],
    ]
    assert [row["follows"] for row in found[:5]] == [None, None, None, "collision", None]
    database.close()


def accountable(verdict: Row) -> str:
    """The accountability of a violation, as docs/reference/oracles.md defines it."""
    if verdict["at_fault"] is None:
        return "undetermined" if verdict["undetermined"] else "not_judged"
    if not verdict["at_fault"]:
        return "not_at_fault"
    degrees = {"no": "unavoidable", "not_measurable": "not_measurable"}
    return degrees.get(verdict["avoidable"] or "yes", "avoidable")


def test_metrics_and_agents_are_those_of_the_reports(world: World, runs: dict[str, Row]) -> None:
    expected = [
        (run_id, kind, name, value)
        for run_id, run in runs.items()
        for kind, values in (
            ("metric", run["report"].get("metrics", {})),
            ("score", run["report"].get("scores", {})),
            ("objective", (run["report"].get("measurement") or {}).get("objectives", {})),
        )
        for name, value in values.items()
    ]
    found = records(frame(world, ResultTableName.METRICS))
    assert [(row["run_id"], row["kind"], row["metric"], row["value"]) for row in found] == expected
    assert {kind for _, kind, _, _ in expected} == {"metric", "score", "objective"}
    labels = {row["run_id"]: row["label"] for row in records(frame(world, ResultTableName.RUNS))}
    assert {label is None for label in labels.values()} == {True, False}
    for name in (ResultTableName.METRICS, ResultTableName.VERDICTS):
        for row in records(frame(world, name)):
            assert row["label"] == labels[row["run_id"]]
    (agent,) = records(frame(world, ResultTableName.AGENTS))
    assert json.loads(agent.pop("parameters")) == {"politeness": 0.1 + 0.2}
    assert agent.pop("label") == labels[agent["run_id"]]
    assert agent.pop("run_id") in runs
    assert agent == {"ego": "ego", "agent": "idm-mobil", "cost_us": 3.25, "privileged": True}


def test_a_csv_file_says_the_same(world: World) -> None:
    for name in ResultTableName:
        columns = {column.name: column for column in COLUMNS[name]}
        texts, values = lines(world, name), records(frame(world, name))
        assert len(texts) == len(values) > 0
        for text, row in zip(texts, values, strict=True):
            assert list(text) == list(row) == list(columns)
            for key, value in row.items():
                assert read(text[key], value) == value, (key, text[key])


def read(text: str, value: Any) -> Any:
    """Reads a cell as the documentation says."""
    if text == "":
        return None
    if isinstance(value, bool):
        return {"true": True, "false": False}[text]
    if isinstance(value, datetime):
        return datetime.fromisoformat(text)
    if isinstance(value, int | float):
        return type(value)(text)
    return text.removeprefix("'")


def test_numbers_are_exact_for_pandas_too(world: World) -> None:
    content = b"".join(
        table_chunks(
            result_table(world.database, ResultTableName.METRICS, EVERYTHING), TableForm.CSV
        )
    )
    table = pd.read_csv(io.BytesIO(content))
    for name, number in ODD_NUMBERS.items():
        (value,) = table.loc[table["metric"] == name, "value"]
        assert math.isnan(value) if number is None else value == number
    gaps = table.loc[table["metric"] == "min_gap", "value"]
    assert math.copysign(1.0, gaps.iloc[0]) == -1.0


def test_no_cell_of_a_csv_file_is_a_formula(world: World) -> None:
    for name in ResultTableName:
        columns = {column.name: column for column in COLUMNS[name]}
        for row in lines(world, name):
            for key, text in row.items():
                if str(columns[key].type) == "string":
                    assert text[:1] not in ("=", "+", "-", "@", "\t", "\r", "\n")
    labels = [row["label"] for row in lines(world, ResultTableName.RUNS)]
    assert [f"'{ODD_LABELS[0]}", f"'{ODD_LABELS[1]}", f"'{ODD_LABELS[2]}"] == labels[:3]


def test_fields_have_their_units_and_meanings(world: World, tmp_path: Path) -> None:
    for name in ResultTableName:
        path = tmp_path / f"{name}.parquet"
        table = result_table(world.database, name, EVERYTHING)
        path.write_bytes(b"".join(table_chunks(table, TableForm.PARQUET)))
        schema = pq.read_schema(path)
        assert schema.names == [column.name for column in COLUMNS[name]]
        for column in COLUMNS[name]:
            field = schema.field(column.name)
            assert field.metadata[b"meaning"].decode() == column.meaning
            assert field.metadata.get(b"unit", b"").decode() == column.unit
            if not column.is_null:
                assert pq.read_table(path)[column.name].null_count == 0


def test_batches_campaigns_and_studies_are_chosen(world: World, runs: dict[str, Row]) -> None:
    def expected(**wanted: str) -> list[str]:
        return [
            run_id for run_id, run in runs.items() if any(run[k] == v for k, v in wanted.items())
        ]

    assert ids(world, ResultFilter(batch_ids=(world.batch,))) == expected(batch_id=world.batch)
    for campaign in (world.local, world.served):
        found = ids(world, ResultFilter(campaign_ids=(campaign,)))
        assert found == expected(campaign_id=campaign)
        assert len(found) >= 12
    of_study = ids(world, ResultFilter(study_ids=(world.study,)))
    assert of_study == expected(study_id=world.study)
    assert len(of_study) >= 16
    several = ResultFilter(batch_ids=(world.batch,), study_ids=(world.study,))
    assert ids(world, several) == [*ids(world, ResultFilter(batch_ids=(world.batch,))), *of_study]
    with world.database.read() as transaction:
        batch = transaction.campaigns.get(world.served).batch_id
    assert ids(world, ResultFilter(batch_ids=(batch,))) == expected(campaign_id=world.served)


@pytest.mark.parametrize(
    "wanted",
    [
        JobFilter(agent="idm"),
        JobFilter(agent="idm-mobil"),
        JobFilter(town="nowhere"),
        JobFilter(statuses=frozenset({RunStatus.FINISHED})),
        JobFilter(statuses=frozenset({RunStatus.QUEUED, RunStatus.AGENT_FAILED})),
        JobFilter(violated=True),
        JobFilter(violated=False),
        JobFilter(at_fault=True),
        JobFilter(accountability=Accountability.UNAVOIDABLE),
        JobFilter(oracle="collision"),
        JobFilter(oracle="collision", at_fault=False),
        JobFilter(oracle="collision", outcome=Outcome.NOT_MEASURABLE),
    ],
    ids=str,
)
def test_runs_are_filtered_as_their_columns_say(world: World, wanted: JobFilter) -> None:
    table = frame(world, ResultTableName.RUNS)
    verdicts = frame(world, ResultTableName.VERDICTS)
    kept = pd.Series(data=True, index=table.index)
    for name in ("agent", "town", "accountability"):
        if getattr(wanted, name):
            kept &= (table[name] == str(getattr(wanted, name))).fillna(value=False)
    if wanted.statuses:
        kept &= table["status"].isin(list(wanted.statuses))
    if wanted.violated is not None:
        kept &= ((table["violations"] > 0) == wanted.violated).fillna(value=False)
    if wanted.oracle:
        said = (verdicts["oracle"] == wanted.oracle) & (verdicts["outcome"] == wanted.outcome)
        if wanted.at_fault is not None:
            said &= (verdicts["at_fault"] == wanted.at_fault).fillna(value=False)
        kept &= table["run_id"].isin(verdicts.loc[said, "run_id"])
    elif wanted.at_fault:
        kept &= (table["at_fault_violations"] > 0).fillna(value=False)
    assert ids(world, ResultFilter(runs=wanted)) == table.loc[kept, "run_id"].tolist()


def test_runs_are_chosen_by_scenario_and_time(world: World) -> None:
    table = frame(world, ResultTableName.RUNS)
    sha256 = table["scenario_sha256"].iloc[-1]
    expected = table.loc[table["scenario_sha256"] == sha256, "run_id"].tolist()
    assert ids(world, ResultFilter(runs=JobFilter(scenario_sha256=sha256))) == expected
    middle = table["created_at"].sort_values().iloc[len(table) // 2].to_pydatetime()
    for wanted, kept in (
        (JobFilter(since=middle), table["created_at"] >= middle),
        (JobFilter(until=middle), table["created_at"] < middle),
    ):
        expected = table.loc[kept, "run_id"].tolist()
        assert 0 < len(expected) < len(table)
        assert ids(world, ResultFilter(runs=wanted)) == expected
    tomorrow = datetime.now(UTC) + timedelta(days=1)
    assert ids(world, ResultFilter(runs=JobFilter(since=tomorrow))) == []


@pytest.mark.parametrize("page", [1, 2, 7])
def test_the_size_of_pages_changes_nothing(
    world: World, runs: dict[str, Row], page: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(result_tables, "_PAGE", page)
    monkeypatch.setattr(result_tables, "_NUMBERS", 2 * page + 1)
    assert ids(world, EVERYTHING) == list(runs)
    chosen = ResultFilter(campaign_ids=(world.served, world.local), runs=JobFilter(violated=True))
    assert set(ids(world, chosen)) == {
        run_id
        for run_id, run in runs.items()
        if run["campaign_id"] in (world.served, world.local)
        and any(one["outcome"] == "violated" for one in run["report"]["verdicts"])
    }


def test_what_does_not_exist_is_refused_before_anything_is_read(world: World) -> None:
    for wanted in (
        ResultFilter(batch_ids=(world.batch, "x")),
        ResultFilter(campaign_ids=("x",)),
        ResultFilter(study_ids=("x",)),
    ):
        with pytest.raises(UnknownName, match="'x'"):
            result_table(world.database, ResultTableName.RUNS, wanted)


_DATA = Path(__file__).parents[2] / "store" / "data"


@pytest.mark.parametrize("revision", ["0001", "0006", "0011", "0015"])
def test_stores_of_older_versions_are_read(revision: str, tmp_path: Path) -> None:
    file = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(file)) as connection:
        connection.executescript((_DATA / f"revision_{revision}.sql").read_text())
        ((runs,),) = connection.execute("SELECT COUNT(*) FROM runs")
        bodies = [body for (body,) in connection.execute("SELECT body FROM reports")]
    database = open_database(f"sqlite:///{file}")
    counts = {}
    for name in ResultTableName:
        content = b"".join(
            table_chunks(result_table(database, name, EVERYTHING), TableForm.PARQUET)
        )
        counts[name] = len(pd.read_parquet(io.BytesIO(content)))
    database.close()
    assert counts[ResultTableName.RUNS] >= runs > 0
    verdicts = sum(len(json.loads(body)["verdicts"]) for body in bodies)
    assert counts[ResultTableName.VERDICTS] >= verdicts > 0


@dataclass
class Peak:
    """Bytes that were allocated at once, more than at the beginning."""

    size: int = 0


@contextmanager
def peak_memory() -> Iterator[Peak]:
    """Measures what Python and Arrow allocate; the memory of a process depends on its machine."""
    peak = Peak()
    before = pa.default_memory_pool()
    # Every such pool begins with nothing allocated.
    own = pa.proxy_memory_pool(before)
    pa.set_memory_pool(own)
    tracemalloc.start()
    try:
        yield peak
        peak.size = tracemalloc.get_traced_memory()[1] + (own.max_memory() or 0)
    finally:
        tracemalloc.stop()
        pa.set_memory_pool(before)


@pytest.mark.slow
def test_a_large_store_is_read_in_bounded_memory(
    world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What the first reading loads and keeps is no part of a table.
    for name in ResultTableName:
        lines(world, name)
        frame(world, name)
    monkeypatch.setattr(result_tables, "_PAGE", 20)
    monkeypatch.setattr(table_forms, "_ROW_GROUP", 100)
    few, many = 200, 1_000
    peaks: dict[tuple[str, TableForm, int], int] = {}
    for size in (few, many):
        folder = tmp_path / str(size)
        folder.mkdir()
        database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
        fill_runs(database, size)
        for name in ResultTableName:
            for form, end in ((TableForm.CSV, "csv"), (TableForm.PARQUET, "parquet")):
                table = result_table(database, name, EVERYTHING)
                with (folder / f"{name}.{end}").open("wb") as written, peak_memory() as peak:
                    written.writelines(table_chunks(table, form))
                peaks[name, form, size] = peak.size
        database.close()
        runs = pq.read_table(folder / "runs.parquet", columns=["run_id"])["run_id"].to_pylist()
        assert len(set(runs)) == len(runs) == size
        with (folder / "runs.csv").open(newline="") as file:
            assert [row["run_id"] for row in csv.DictReader(file)] == runs
        with closing(sqlite3.connect(folder / "drivora.sqlite3")) as connection:
            ((expected,),) = connection.execute(
                "SELECT SUM(json_array_length(body, '$.verdicts')) FROM reports"
            )
        assert pq.read_metadata(folder / "verdicts.parquet").num_rows == expected > size
    # Bytes: 300 kB, and 1.4 MB or more where all rows of a table are in memory at once.
    growths = {
        (name, form): peaks[name, form, many] - peaks[name, form, few]
        for name, form, size in peaks
        if size == few
    }
    assert max(growths.values()) < 700_000, growths
