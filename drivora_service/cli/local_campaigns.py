"""Campaigns of this machine's data folder."""

from __future__ import annotations

import contextlib
import json
import shutil
import signal
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.campaigns.conducting import Watcher
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.evaluators import evaluator_plugins
from drivora_service.campaigns.preparing import prepare_search
from drivora_service.campaigns.reading import Catalogues, read_campaign
from drivora_service.campaigns.stored import CampaignFolder, ask_for, new_campaign, run_stored
from drivora_service.cli.campaign_display import campaign_display
from drivora_service.cli.campaign_files import read_campaign_file
from drivora_service.cli.campaign_results import campaign_result
from drivora_service.cli.embedded import network_catalogue, settings_for
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.search.catalogue import TesterCatalogue
from drivora_service.settings import Settings
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    EvaluationRecord,
    FailureRecord,
)
from drivora_service.store.database import Database, open_database
from drivora_service.worker_settings import run_limits, worker_setup


class LocalCampaigns:
    """Runs and shows campaigns; a context manager that closes the database."""

    def __init__(self, data_dir: Path | None) -> None:
        """Opens the data folder's database."""
        self._settings: Settings = settings_for(data_dir)
        self._database: Database = open_database(self._settings.resolved_database_url)

    def __enter__(self) -> LocalCampaigns:
        """Gives the object itself."""
        return self

    def __exit__(self, *_exception: object) -> None:
        """Closes the database."""
        self._database.close()

    def create(self, path: Path) -> tuple[CampaignRecord, tuple[str, ...]]:
        """Reads a campaign file and stores its campaign; gives notes for people as well.

        Raises:
            ConfigurationError: The file cannot be read.
            InvalidDocument: It cannot be run.
        """
        catalogues = self._catalogues()
        valid = read_campaign(read_campaign_file(path), catalogues)
        # What the space and the tester refuse, they shall refuse before anything is stored.
        prepare_search(valid, catalogues, run_prefix="")
        with self._database.write() as transaction:
            return transaction.campaigns.create(new_campaign(valid)), valid.notes

    def run(self, campaign_id: str, *, workers: int | None, evaluator: str) -> CampaignRecord:
        """Runs a campaign or goes on with it; an interrupt pauses it.

        Args:
            campaign_id: Which.
            workers: In place of the campaign's own number.
            evaluator: Name of the evaluator.

        Raises:
            Conflict: Another process runs it, or it is over.
            CampaignError: It cannot go on.
            UnknownName: There is no such campaign or evaluator.
        """
        plugin = evaluator_plugins().plugin(evaluator)
        record, _ = self.show(campaign_id)

        @contextlib.contextmanager
        def evaluating(wanted: int | None) -> Iterator[Evaluator]:
            with tempfile.TemporaryDirectory(prefix="drivora-") as folder:
                context = EvaluatorContext(
                    workers=workers or wanted or self._settings.workers,
                    setup=worker_setup(self._settings),
                    limits=run_limits(self._settings),
                    folder=Path(folder),
                )
                with contextlib.closing(plugin.create(context)) as made:
                    yield made

        with campaign_display(record.budget) as display, _pause_on_interrupt() as requested:
            watcher = Watcher(
                requested=requested, on_told=display.on_told, on_confirmed=display.on_confirmed
            )
            return run_stored(
                self._database,
                campaign_id,
                self.folder(campaign_id),
                catalogues=self._catalogues(),
                evaluator=evaluating,
                watcher=watcher,
            )

    def show(self, campaign_id: str) -> tuple[CampaignRecord, tuple[FailureRecord, ...]]:
        """Gives a campaign and its failures.

        Raises:
            UnknownName: There is no such campaign.
        """
        with self._database.read() as transaction:
            record = transaction.campaigns.get(campaign_id)
            return record, transaction.evaluations.failures(campaign_id)

    def newest(self, limit: int) -> tuple[CampaignRecord, ...]:
        """Gives the newest campaigns first."""
        with self._database.read() as transaction:
            return transaction.campaigns.page(limit=limit).items

    def lineage(self, campaign_id: str, number: int) -> tuple[EvaluationRecord, ...]:
        """Gives an evaluation, last, and its ancestors.

        Raises:
            UnknownName: There is no such campaign or evaluation.
        """
        with self._database.read() as transaction:
            return transaction.evaluations.lineage(campaign_id, number)

    def scenario(self, campaign_id: str, number: int) -> str:
        """Gives the scenario of an evaluation as the text of a document.

        Raises:
            UnknownName: There is no such campaign or evaluation, or it is invalid.
        """
        with self._database.read() as transaction:
            canonical = transaction.evaluations.document(campaign_id, number)
        return document_text(to_document(from_canonical(canonical)))

    def ask_for(self, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
        """Pauses or cancels a campaign.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, so that it cannot be paused.
        """
        return ask_for(self._database, campaign_id, self.folder(campaign_id), request)

    def folder(self, campaign_id: str) -> CampaignFolder:
        """Gives the folder of a campaign."""
        return CampaignFolder(self._settings.campaigns_dir, campaign_id)

    def is_running(self, record: CampaignRecord) -> bool:
        """Whether a process works on a campaign."""
        return self.folder(record.id).is_running

    def export(self, campaign_id: str, target: Path) -> None:
        """Writes a campaign's summary, and the scenario and trace of each failing evaluation."""
        record, failures = self.show(campaign_id)
        target.mkdir(parents=True, exist_ok=True)
        summary = campaign_result(record, failures, running=False)
        (target / "campaign.json").write_text(_json(summary))
        for failure in failures:
            name = f"{failure.number:06d}"
            (target / f"{name}.json").write_text(self.scenario(campaign_id, failure.number))
            trace = self.folder(campaign_id).traces / failure.trace
            if trace.is_file():
                shutil.copyfile(trace, target / f"{name}.trace.parquet")

    def _catalogues(self) -> Catalogues:
        return Catalogues(
            networks=network_catalogue(self._settings),
            agents=AgentCatalogue(),
            testers=TesterCatalogue(),
        )


@contextlib.contextmanager
def _pause_on_interrupt() -> Iterator[Callable[[], CampaignRequest]]:
    """Makes the first interrupt or request to terminate a wish to pause; the next one ends."""
    asked = False

    def note_it(number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        asked = True
        signal.signal(number, signal.default_int_handler)

    before = {number: signal.signal(number, note_it) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: CampaignRequest.PAUSE if asked else CampaignRequest.NONE
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _json(value: object) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"
