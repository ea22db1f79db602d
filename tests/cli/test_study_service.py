"""A finished study: as its campaigns by themselves, and as a service with its data shows it."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.store.database import Database, open_database
from tests.campaigns.analytic import sequence
from tests.cli.conftest import Drivora
from tests.command_process import begin
from tests.forked_service import forked_service

STUDY = """
name: models
scenarios: [{file: crossing.json}]
agents: [{name: idm}]
methods:
  - {name: behavexplor}
  - name: samota
    parameters:
      {initial: 8, pool: 4, population: 8, generations: 4, cluster: 2, local_population: 8}
repetitions: 2
space: {vehicles: 2, walkers: 1}
oracles: [collision, discomfort]
budget: {simulations: 20}
workers: 2
"""

# They start a command with workers, whose campaigns fit models. Below twenty seconds each, they go
# to one process of the tests, which makes the study once.
pytestmark = pytest.mark.slow(seconds=15)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The data folder of a study that has finished."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "crossing.json").write_text(json.dumps(SCENARIO))
    (folder / "study.yaml").write_text(STUDY)
    data = folder / "data"
    log = folder / "study.log"
    command = ("study", "run", "study.yaml", "--data-dir", data)
    begun = begin(*command, folder=folder, environment=os.environ, out=log, err=log)
    assert begun.wait(600.0) == 0, log.read_text()
    return data


@pytest.fixture
def database(data: Path) -> Iterator[Database]:
    database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    yield database
    database.close()


@pytest.fixture
def study_id(database: Database) -> str:
    with database.read() as transaction:
        (study,) = transaction.studies.page().items
    return study.id


def evaluations(database: Database, campaign_id: str) -> list[EvaluationRecord]:
    return list(StoreJournal(database, campaign_id).evaluations())


@pytest.mark.parametrize("method", ["behavexplor", "samota"])
def test_a_campaign_of_a_study_is_the_same_by_itself(
    drivora: Drivora, data: Path, database: Database, study_id: str, tmp_path: Path, method: str
) -> None:
    with database.read() as transaction:
        ids = transaction.studies.campaign_ids(study_id)
        records = [transaction.campaigns.get(campaign_id) for campaign_id in ids]
    of_study = next(r for r in records if r.cell is not None and r.cell.method == method)
    file = tmp_path / "alone.json"
    file.write_text(json.dumps(of_study.document))
    # With another number of workers, too.
    ended = drivora("campaign", "run", file, "--workers", "1", "--data-dir", data, "--json")
    assert ended.code == 0, ended.err
    alone = sequence(evaluations(database, ended.json()["id"]))
    assert alone == sequence(evaluations(database, of_study.id))
    assert len(alone) >= 20
    origins = {record.proposal.origin for record in evaluations(database, of_study.id)}
    assert len(origins) > 1, "the search never went beyond its first draws"


def test_a_service_shows_compares_and_exports_the_same(
    drivora: Drivora, data: Path, study_id: str, tmp_path: Path
) -> None:
    asked = {
        name: ("study", name, study_id, *options)
        for name, options in (
            ("show", ()),
            ("compare", ("--out", tmp_path / "compared")),
            ("export", ("--out", tmp_path / "exported")),
        )
    }
    here = {name: drivora(*arguments, "--data-dir", data) for name, arguments in asked.items()}
    files = {path: path.read_bytes() for path in tmp_path.glob("*ed/*")}
    assert len(files) == 9 + 6
    for path in files:
        path.unlink()
    with forked_service(data, workers=1) as url:
        there = {
            # Another data folder: all comes from the service.
            name: drivora(*arguments, "--server", url, DRIVORA_DATA_DIR=str(tmp_path / "none"))
            for name, arguments in asked.items()
        }
    for name in asked:
        assert (there[name].code, there[name].out) == (0, here[name].out), there[name].err
    assert "By scenario and agent" in there["show"].out
    assert "Overview by method, against behavexplor" in there["compare"].out
    pictures = {".svg", ".png"}
    assert set(tmp_path.glob("*ed/*")) == set(files)
    for path, content in files.items():
        assert path.suffix in pictures or path.read_bytes() == content, path
