"""Stored studies and the states that follow from those of their campaigns."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.errors import Conflict, InvalidDocument, UnknownName
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.campaigns.seed_run_records import SeedRun
from drivora_service.store.campaigns.study_records import StudyState, state_of, study_warnings
from drivora_service.store.database import Database
from drivora_service.store.locks.work_locks import LongWork
from drivora_service.studies.study_storing import stop_study
from tests.store.campaigns.test_campaign_repository import create
from tests.studies.example_study import stored

QUEUED, RUNNING = CampaignState.QUEUED, CampaignState.RUNNING
FINISHED, PAUSED = CampaignState.FINISHED, CampaignState.PAUSED


def state(database: Database, study_id: str, *, has_process: bool = False) -> StudyState:
    with database.read() as transaction:
        return state_of(transaction.studies.get(study_id), has_process=has_process)


def set_states(database: Database, study_id: str, *states: CampaignState) -> None:
    """Sets the states of the first campaigns."""
    with database.write() as transaction:
        ids = transaction.studies.campaign_ids(study_id)
        for campaign_id, wanted in zip(ids, states, strict=False):
            transaction.campaigns.begin(campaign_id)
            if wanted is not RUNNING:
                transaction.campaigns.end(campaign_id, wanted)


def test_a_study_is_read_back_with_its_campaigns_in_their_order(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    other = stored(database, catalogues, tmp_path, name="other", repetitions=1)
    with database.read() as transaction:
        study = transaction.studies.get(study_id)
        ids = transaction.studies.campaign_ids(study_id)
        pages = [transaction.campaigns.page(study_id=study_id, limit=10)]
        token = pages[0].next_page_token
        pages.append(transaction.campaigns.page(study_id=study_id, limit=10, page_token=token))
        everything = transaction.campaigns.page(limit=100).items
        with pytest.raises(InvalidDocument):
            transaction.campaigns.page(study_id=other, page_token=token)
        listed = transaction.studies.page(limit=1)
        rest = transaction.studies.page(limit=1, page_token=listed.next_page_token)
    assert (study.name, study.budget, study.simulations) == ("crossings", 16 * 8, 0)
    assert study.campaigns == {QUEUED: 16}
    assert study.document["repetitions"] == 2
    assert [one.id for page in pages for one in page.items] == list(reversed(ids))
    first = pages[1].items[-1]
    assert first.study_id == study_id
    assert first.cell is not None
    assert (first.cell.scenario, first.cell.agent, first.cell.method, first.cell.repetition) == (
        "first",
        "idm",
        "random",
        1,
    )
    assert len(everything) == 24
    assert [one.id for one in (*listed.items, *rest.items)] == [other, study_id]
    assert rest.next_page_token == ""


def test_an_unknown_study_is_refused_with_those_that_there_are(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    with database.read() as transaction, pytest.raises(UnknownName, match=study_id):
        transaction.studies.get("0123")


@pytest.mark.parametrize(
    ("states", "has_process", "expected"),
    [
        ((), False, StudyState.INTERRUPTED),
        ((), True, StudyState.RUNNING),
        ((RUNNING, FINISHED), False, StudyState.INTERRUPTED),
        ((RUNNING, FINISHED), True, StudyState.RUNNING),
        ((FINISHED,) * 16, False, StudyState.FINISHED),
        ((FINISHED,) * 15 + (PAUSED,), False, StudyState.PAUSED),
        # The process of a command has just begun to resume it.
        ((FINISHED,) * 15 + (PAUSED,), True, StudyState.RUNNING),
        ((FINISHED,) * 15 + (CampaignState.FAILED,), True, StudyState.RUNNING),
        # It has not let go of it yet.
        ((FINISHED,) * 16, True, StudyState.FINISHED),
        ((FINISHED,) * 15 + (CampaignState.FAILED,), False, StudyState.FAILED),
        ((FINISHED,) * 15 + (CampaignState.CANCELLED,), False, StudyState.CANCELLED),
    ],
)
def test_the_state_follows_from_the_campaigns_and_their_process(
    database: Database,
    catalogues: Catalogues,
    tmp_path: Path,
    states: tuple[CampaignState, ...],
    has_process: bool,
    expected: StudyState,
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    set_states(database, study_id, *states)
    assert state(database, study_id, has_process=has_process) is expected


def test_a_pause_reaches_every_campaign(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    set_states(database, study_id, FINISHED, RUNNING)

    stop_study(database, study_id, CampaignRequest.PAUSE)
    with database.read() as transaction:
        study = transaction.studies.get(study_id)
    # No process runs the campaign that is stored as running.
    assert study.campaigns == {FINISHED: 1, PAUSED: 15}
    assert study.request is CampaignRequest.PAUSE
    assert state(database, study_id) is StudyState.PAUSED
    assert state(database, study_id, has_process=True) is StudyState.PAUSED
    with database.write() as transaction:
        for campaign_id in transaction.studies.campaign_ids(study_id, (PAUSED,)):
            transaction.campaigns.end(campaign_id, CampaignState.CANCELLED)
    with pytest.raises(Conflict, match="are over"):
        stop_study(database, study_id, CampaignRequest.PAUSE)


def test_a_cancellation_ends_every_campaign_that_is_not_over(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    set_states(database, study_id, FINISHED, RUNNING, RUNNING, PAUSED, CampaignState.FAILED)

    with database.read() as transaction:
        running = transaction.studies.campaign_ids(study_id, (RUNNING,))[0]
    lock = database.locks.hold(LongWork.campaign(running))
    try:
        stop_study(database, study_id, CampaignRequest.CANCEL)
        # A pause afterwards replaces neither the study's request nor the campaign's.
        stop_study(database, study_id, CampaignRequest.PAUSE)
    finally:
        lock.release()
    with database.read() as transaction:
        study = transaction.studies.get(study_id)
        assert transaction.campaigns.request_of(running) is CampaignRequest.CANCEL
    assert study.campaigns == {FINISHED: 1, RUNNING: 1, CampaignState.CANCELLED: 14}
    assert study.request is CampaignRequest.CANCEL
    # The process of the last one follows the request.
    with database.write() as transaction:
        transaction.campaigns.end(running, CampaignState.CANCELLED)
    assert state(database, study_id) is StudyState.CANCELLED
    stop_study(database, study_id, CampaignRequest.CANCEL)
    assert state(database, study_id) is StudyState.CANCELLED
    finished = stored(database, catalogues, tmp_path)
    set_states(database, finished, *(FINISHED,) * 16)
    with pytest.raises(Conflict, match="are over"):
        stop_study(database, finished, CampaignRequest.CANCEL)


def test_the_scenes_of_a_study_have_the_runs_of_their_seeds(
    database: Database, catalogues: Catalogues, tmp_path: Path
) -> None:
    study_id = stored(database, catalogues, tmp_path)
    stored(database, catalogues, tmp_path, name="other")
    alone = create(database)
    violated = Verdict(oracle="collision", ego="ego_0", outcome=Outcome.VIOLATED, message="m")
    run = SeedRun(place=0, name="", run_id="r", status=RunStatus.FINISHED, failures=(violated,))
    with database.write() as transaction:
        ids = transaction.studies.campaign_ids(study_id)
        first = [one for one in ids if transaction.campaigns.is_first_of_its_scene(one)]
        cells = [transaction.campaigns.get(one).cell for one in first]
        transaction.campaigns.keep_seed_runs(first[1], (run,))
        transaction.session.execute(
            text("UPDATE campaigns SET judged = 3, violating = 2 WHERE id = :id"), {"id": ids[0]}
        )
    assert len(first) == 4
    assert {(cell.method, cell.repetition) for cell in cells if cell} == {("random", 1)}
    with database.read() as transaction:
        scenes = transaction.studies.scenes(study_id)
        assert transaction.campaigns.is_first_of_its_scene(alone)
    assert [(one.scenario, one.agent) for one in scenes] == [
        (cell.scenario, cell.agent) for cell in cells if cell
    ]
    assert [one.seed_runs for one in scenes] == [(), (run,), (), ()]
    assert (scenes[0].counts.judged, scenes[0].counts.violating) == (3, 2)
    assert not any(one.is_finished for one in scenes)
    (warning,) = study_warnings(scenes)
    assert warning.message == "first, idm-mobil: The seed scenario itself fails: collision."
    set_states(database, study_id, *[FINISHED] * 16)
    with database.read() as transaction:
        assert all(one.is_finished for one in transaction.studies.scenes(study_id))
