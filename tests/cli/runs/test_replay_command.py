"""``drivora replay``: runs that are the same again, and runs that are not."""

from __future__ import annotations

import importlib
import json
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli import unsteady_agents
from tests.cli.conftest import Drivora, Ended, install_agents

STEP_S = 0.05
SHORT = {**SCENARIO, "max_sim_time": 5.0}
WITH_OTHERS = {
    **SHORT,
    "npc_vehicles": [
        {
            "id": "npc",
            "model": "vehicle.tesla.model3",
            "route": [{"x": 26.5, "y": 6.86}, {"x": 3.01, "y": 104.32}],
            "start_time": 2.5,
        }
    ],
}

Driven = Callable[..., dict[str, Any]]


@pytest.fixture
def driven(drivora: Drivora, tmp_path: Path) -> Driven:
    """Runs a scenario, and returns the stored run."""

    def run(document: dict[str, Any], *options: str | Path) -> dict[str, Any]:
        path = tmp_path / "scenario.json"
        path.write_text(json.dumps(document))
        ended = drivora("run", path, *options, "--workers", "1", "--json")
        assert ended.out, ended.err
        result: dict[str, Any] = ended.json()
        assert result["id"], result["error"]
        return result

    return run


def the_only(ended: Ended) -> dict[str, Any]:
    (run,) = ended.json()["runs"]
    assert isinstance(run, dict)
    return run


def database(tmp_path: Path) -> sqlite3.Connection:
    return sqlite3.connect(tmp_path / "data" / "drivora.sqlite3")


def stored_trace(tmp_path: Path, run_id: str) -> Path:
    (path,) = (tmp_path / "data" / "traces").glob(f"*/{run_id}.parquet")
    return path


def first_difference(one: Path, other: Path) -> tuple[int, dict[tuple[str, str], tuple[Any, Any]]]:
    """Returns the first step at which two files differ, and actors and columns with their values.

    By pandas alone, from the columns that the reference of the trace file describes.
    """
    frames = []
    for path in (one, other):
        table = pq.read_table(path)
        header = json.loads(table.schema.metadata[b"drivora_trace"])
        frame = (
            table.drop(["plan"]).to_pandas() if "plan" in table.column_names else table.to_pandas()
        )
        frame["actor"] = [header["actors"][row]["id"] for row in frame["actor"]]
        frames.append(frame.set_index(["step", "actor"]))
    left, right = frames[0].align(frames[1], join="outer")
    unequal = (left != right) & ~(left.isna() & right.isna())
    rows = unequal[unequal.any(axis=1)]
    step = int(rows.index.get_level_values("step").min())
    return step, {
        (actor, column): (left.loc[(step, actor), column], right.loc[(step, actor), column])
        for actor, flags in rows.loc[step].iterrows()
        for column in flags.index[flags]
    }


def assert_as_pandas_finds_it(replay: dict[str, Any], out: Path) -> None:
    """Compares a divergence with the files that were written of it."""
    files = [Path(file) for file in replay["files"]]
    assert [file.parent for file in files] == [out, out]
    step, places = first_difference(*files)
    told = replay["divergence"]
    assert told["step"] == step
    assert told["time"] == pytest.approx(step * STEP_S)
    found = {(one["actor"], one["signal"]): one for one in told["differences"]}
    assert set(found) == set(places)
    for place, values in places.items():
        for value, name in zip(values, ("original", "replayed"), strict=True):
            assert found[place][name] == (None if pd.isna(value) else value)
    assert told["signals"] == len(places)
    assert told["actors"] == len({actor for actor, _ in places})
    first = told["differences"][0]
    assert {key: told[key] for key in first} == first


def test_a_run_is_replayed_with_what_was_set_beside_its_document(
    drivora: Drivora, driven: Driven
) -> None:
    plain = driven(WITH_OTHERS)
    setting = (
        "--seed",
        "7",
        "--agent",
        "sumo-krauss",
        "--agent-parameter",
        "lane_change_model=SL2015",
    )
    run = driven(WITH_OTHERS, *setting)
    other_agent = driven(WITH_OTHERS, "--agent", "idm-mobil")
    hashes = {one["trace_sha256"] for one in (plain, run, other_agent)}
    assert len(hashes) == 3
    ids = [one["id"] for one in (plain, run, other_agent)]
    ended = drivora("replay", *ids, "--json")
    assert ended.code == 0, ended.err
    replays = ended.json()["runs"]
    assert [one["run"]["id"] for one in replays] == ids
    for replay, original in zip(replays, (plain, run, other_agent), strict=True):
        assert replay["outcome"] == "identical"
        assert replay["reason"] == ""
        assert replay["frames_compared"]
        assert replay["divergence"] is None
        assert replay["versions"] == replay["verdicts"] == replay["facts"] == []
        assert replay["replay"]["trace_sha256"] == original["trace_sha256"]
        assert replay["run"]["trace_sha256"] == original["trace_sha256"]
        again = drivora("runs", "show", replay["replay"]["id"], "--json").json()
        assert again["label"] == f"replay of {original['id']}"
        assert again["seed"] == original["seed"]
        assert again["agents"] == original["agents"]
        assert again["verdicts"] == original["verdicts"]

    batch = drivora("replay", "--batch", again["batch_id"])
    assert batch.code == 0, batch.err
    assert "Runs: 3; identical: 3; diverged: 0; not replayed: 0" in batch.out


def test_draws_without_a_seed_are_found_at_the_first_one(
    drivora: Drivora, driven: Driven, site: Path, tmp_path: Path
) -> None:
    run = driven(WITH_OTHERS, "--agent", "dicing")
    assert run["status"] == "finished"
    install_agents(site, version="1.1")
    out = tmp_path / "out"
    ended = drivora("replay", run["id"], "--out", out, "--json")
    assert ended.code == 1, ended.err
    replay = the_only(ended)
    assert replay["outcome"] == "diverged"
    assert replay["reason"] == "the hashes of the traces differ"
    told = replay["divergence"]
    assert told["step"] == round(unsteady_agents.DICES_FROM_S / STEP_S)
    assert (told["actor"], told["signal"]) == ("ego", "ego_acceleration")
    assert replay["versions"] == [{"name": "unsteady-agents", "original": "1.0", "replayed": "1.1"}]
    assert_as_pandas_finds_it(replay, out)

    table = drivora("replay", run["id"])
    assert table.code == 1
    assert "first difference: frame 20 (1 s), ego ego_acceleration" in table.out
    assert f"ego ego_acceleration: {json.dumps(told['original'])}, replayed" in table.out
    assert "version of unsteady-agents: 1.0, replayed 1.1" in table.out
    assert "Runs: 1; identical: 0; diverged: 1; not replayed: 0" in table.out


def test_what_an_agent_keeps_between_runs_is_found(
    drivora: Drivora, driven: Driven, site: Path, tmp_path: Path
) -> None:
    notes = tmp_path / "notes"
    notes.mkdir()
    setting = ("--agent", "remembering", "--agent-parameter", f"notes={notes}")
    run = driven(SHORT, *setting)
    out = tmp_path / "out"
    replay = the_only(drivora("replay", run["id"], "--out", out, "--json"))
    told = replay["divergence"]
    assert told["step"] == round(unsteady_agents.REMEMBERS_FROM_S / STEP_S)
    assert (told["actor"], told["signal"], told["replayed"]) == ("ego", "ego_acceleration", -3.0)
    assert replay["versions"] == []
    assert_as_pandas_finds_it(replay, out)


def test_runs_without_a_trace_are_compared_by_status_and_cause(
    drivora: Drivora, driven: Driven, site: Path, tmp_path: Path
) -> None:
    failed = driven(SHORT, "--agent", "failing")
    assert (failed["status"], failed["cause"]) == ("agent_failed", "agent_raised")
    ended = drivora("replay", failed["id"], "--json")
    assert ended.code == 0, ended.err
    replay = the_only(ended)
    assert replay["outcome"] == "identical"
    assert not replay["frames_compared"]
    assert replay["reason"] == "there are no traces: status and cause were compared"
    assert replay["replay"]["cause"] == "agent_raised"

    notes = tmp_path / "notes"
    notes.mkdir()
    parameters = (f"notes={notes}", "fails=true")
    options = [word for each in parameters for word in ("--agent-parameter", each)]
    once = driven(SHORT, "--agent", "remembering", *options)
    ended = drivora("replay", once["id"], "--json")
    assert ended.code == 1, ended.err
    replay = the_only(ended)
    assert replay["outcome"] == "diverged"
    assert replay["reason"].startswith(
        "it ended as finished, its replay as agent failed (agent_raised)"
    )
    assert replay["reason"].endswith("no frame and actor can be named: the replay has no recording")
    assert replay["divergence"] is None


def test_a_changed_scenario_diverges_at_the_start(
    drivora: Drivora, driven: Driven, tmp_path: Path
) -> None:
    run = driven(WITH_OTHERS)
    with closing(database(tmp_path)) as connection, connection:
        ((body,),) = connection.execute("SELECT body FROM documents").fetchall()
        content = json.loads(body)
        content["npc_vehicles"][0]["route"][0]["x"] += 2.0**-20
        connection.execute("UPDATE documents SET body = ?", (json.dumps(content),))
    out = tmp_path / "out"
    ended = drivora("replay", run["id"], "--out", out, "--json")
    assert ended.code == 1, ended.err
    replay = the_only(ended)
    assert replay["divergence"]["actor"] == "npc"
    assert "scenario_sha256" in [fact["fact"] for fact in replay["facts"]]
    assert_as_pandas_finds_it(replay, out)


def test_a_changed_recording_is_told_though_the_hashes_are_the_same(
    drivora: Drivora, driven: Driven, tmp_path: Path
) -> None:
    run = driven(WITH_OTHERS)
    path = stored_trace(tmp_path, run["id"])
    table = pq.read_table(path)
    place = pc.and_(pc.equal(table["step"], 60), pc.equal(table["actor"], 1))
    assert pc.sum(place).as_py() == 1
    changed = pc.if_else(place, pc.add(table["vy"], 1e-9), table["vy"])
    column = table.column_names.index("vy")
    pq.write_table(table.set_column(column, "vy", pa.chunked_array(changed)), path)
    out = tmp_path / "out"
    ended = drivora("replay", run["id"], "--out", out, "--json")
    assert ended.code == 1, ended.err
    replay = the_only(ended)
    assert replay["outcome"] == "diverged"
    assert replay["run"]["trace_sha256"] == replay["replay"]["trace_sha256"]
    # The file says nothing about the run any more: no frame of it is compared.
    assert (replay["frames_compared"], replay["divergence"]) == (False, None)
    assert f"run {run['id']}: its trace file {path.name} is damaged" in replay["reason"]
    assert "the hash of the replay is the one that was recorded" in replay["reason"]
    assert [Path(file).name for file in replay["files"]] == [f"{run['id']}.replayed.trace.parquet"]


def test_without_a_recording_the_hash_is_compared(
    drivora: Drivora, driven: Driven, site: Path, tmp_path: Path
) -> None:
    same = driven(SHORT)
    other = driven(SHORT, "--agent", "dicing")
    assert drivora("store", "prune", "--older-than", "0", "--only-traces").code == 0
    pruned = drivora("runs", "show", same["id"], "--json").json()
    assert pruned["trace_sha256"] == pruned["observations_url"] == ""
    assert pruned["simulation_sha256"] == same["trace_sha256"]
    out = tmp_path / "out"
    ended = drivora("replay", same["id"], other["id"], "--out", out, "--json")
    assert ended.code == 1, ended.err
    identical, diverged = ended.json()["runs"]
    assert identical["outcome"] == "identical"
    assert not identical["frames_compared"]
    assert identical["reason"] == (
        "the hashes were compared, not the frames: the run has no recording"
    )
    assert identical["run"]["trace_sha256"] == same["trace_sha256"]
    assert diverged["outcome"] == "diverged"
    assert diverged["divergence"] is None
    assert diverged["reason"].endswith("no frame and actor can be named: the run has no recording")
    assert [Path(file).name for file in diverged["files"]] == [
        f"{other['id']}.replayed.trace.parquet"
    ]


def test_what_cannot_be_run_again_is_named_and_the_rest_is_replayed(
    drivora: Drivora, driven: Driven, site: Path, tmp_path: Path
) -> None:
    gone, fine = driven(SHORT, "--agent", "dicing"), driven(SHORT)
    cancelled = driven(SHORT)
    with closing(database(tmp_path)) as connection, connection:
        connection.execute("UPDATE runs SET status = 'cancelled' WHERE id = ?", (cancelled["id"],))
    shutil.rmtree(site)
    importlib.invalidate_caches()
    ended = drivora("replay", gone["id"], fine["id"], cancelled["id"], "--json")
    assert ended.code == 3, ended.err
    first, second, third = ended.json()["runs"]
    assert first["outcome"] == "not_replayed"
    assert first["replay"] is None
    assert "cannot be run here" in first["reason"]
    assert "dicing" in first["reason"]
    assert second["outcome"] == "identical"
    assert third["outcome"] == "not_replayed"
    assert third["reason"] == "it has no result to compare with, cancelled"
    alone = drivora("replay", gone["id"])
    assert alone.code == 3
    assert "cannot be run here" in alone.out


def test_what_is_not_stored_is_a_usage_error(drivora: Drivora, driven: Driven) -> None:
    run = driven(SHORT)
    unknown = "0123456789abcdef01234567"
    for arguments, said in (
        ([], "name the runs to replay"),
        ([unknown], unknown),
        (["--batch", unknown], "batch"),
        (["--campaign", unknown], "campaign"),
    ):
        ended = drivora("replay", *arguments)
        assert ended.code == 2, arguments
        assert said in ended.err
        # Nothing is run if one of several is unknown.
        if arguments:
            assert drivora("replay", run["id"], *arguments).code == 2, arguments
            assert len(drivora("runs", "list", "--json").json()) == 1, arguments
    assert drivora("replay", run["id"]).code == 0
    assert len(drivora("runs", "list", "--json").json()) == 2


def test_without_anything_stored_it_says_so(drivora: Drivora) -> None:
    assert drivora("replay", "0123456789abcdef01234567").code == 2
