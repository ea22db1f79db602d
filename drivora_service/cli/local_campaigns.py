"""``drivora campaign run`` and ``resume`` without a service."""

from __future__ import annotations

import contextlib
import signal
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType

from drivora_service.campaigns.catalogues import installed_catalogues
from drivora_service.campaigns.conducting import Watcher
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.evaluators import evaluator_plugins
from drivora_service.campaigns.preparing import prepare_search
from drivora_service.campaigns.reading import read_campaign
from drivora_service.campaigns.stored import new_campaign, run_stored
from drivora_service.cli.campaign_display import campaign_display
from drivora_service.cli.campaign_files import read_campaign_file
from drivora_service.cli.embedded import network_catalogue
from drivora_service.cli.stored_campaigns import StoredCampaigns
from drivora_service.store.campaign_records import CampaignRecord, CampaignRequest
from drivora_service.worker_settings import run_limits, worker_setup


def create_campaign(
    campaigns: StoredCampaigns, path: Path, *, workers: int | None
) -> tuple[CampaignRecord, tuple[str, ...]]:
    """Reads a campaign file and stores its campaign; gives notes for people as well.

    Args:
        campaigns: The data folder.
        path: The file.
        workers: In place of the campaign's own number.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It cannot be run.
    """
    catalogues = installed_catalogues(
        network_catalogue(campaigns.settings), campaigns.settings.agents_folder
    )
    valid = read_campaign(read_campaign_file(path), catalogues)
    # What the space and the tester refuse, they shall refuse before anything is stored.
    prepare_search(valid, catalogues, run_prefix="")
    notes = valid.notes_for(workers or valid.campaign.workers or campaigns.settings.workers)
    with campaigns.database.write() as transaction:
        return transaction.campaigns.create(new_campaign(valid)), notes


def run_campaign(
    campaigns: StoredCampaigns, campaign_id: str, *, workers: int | None, evaluator: str
) -> CampaignRecord:
    """Runs a campaign or goes on with it; an interrupt pauses it.

    Args:
        campaigns: The data folder.
        campaign_id: Which.
        workers: In place of the campaign's own number.
        evaluator: Name of the evaluator.

    Raises:
        Conflict: Another process runs it, or it is over.
        CampaignError: It cannot go on.
        UnknownName: There is no such campaign or evaluator.
    """
    plugin = evaluator_plugins().plugin(evaluator)
    settings = campaigns.settings
    record = campaigns.record(campaign_id)

    @contextlib.contextmanager
    def evaluating(wanted: int | None) -> Iterator[Evaluator]:
        with tempfile.TemporaryDirectory(prefix="drivora-") as folder:
            context = EvaluatorContext(
                workers=workers or wanted or settings.workers,
                setup=worker_setup(settings),
                limits=run_limits(settings),
                folder=Path(folder),
            )
            with contextlib.closing(plugin.create(context)) as made:
                yield made

    with campaign_display(record.budget) as display, _pause_on_interrupt() as requested:
        watcher = Watcher(
            requested=requested, on_told=display.on_told, on_confirmed=display.on_confirmed
        )
        return run_stored(
            campaigns.database,
            campaign_id,
            campaigns.folder(campaign_id),
            catalogues=installed_catalogues(network_catalogue(settings), settings.agents_folder),
            evaluator=evaluating,
            watcher=watcher,
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
