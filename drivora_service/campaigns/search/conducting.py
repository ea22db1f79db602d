"""A campaign from its first evaluation to its failures, confirmed and grouped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.confirmation import confirm_failures, group_failures
from drivora_service.campaigns.search.engine import Engine, Search, Told
from drivora_service.campaigns.search.seed_trial import SeedTrial
from drivora_service.campaigns.search.tester_calls import TesterCall
from drivora_service.campaigns.search.warning_watch import WarningWatch
from drivora_service.store.campaigns.campaign_records import (
    CampaignRequest,
    CampaignState,
    Confirmation,
)
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning


@dataclass(frozen=True, slots=True, kw_only=True)
class Watcher:
    """The callbacks of a running campaign.

    Attributes:
        on_begun: Called when the campaign is stored as running.
        requested: Returns a pending request to stop.
        on_told: Called with every evaluation.
        on_confirmed: Called with the number and the confirmation of every failing evaluation that
            was run again.
        on_call: Called when a call of the tester begins, and with ``NONE`` when it ends.
        on_warning: Called once with each kind of warning that the campaign says little.
    """

    on_begun: Callable[[], None] = lambda: None
    requested: Callable[[], CampaignRequest] = lambda: CampaignRequest.NONE
    on_told: Callable[[Told], None] = lambda _told: None
    on_confirmed: Callable[[int, Confirmation], None] = lambda _number, _confirmation: None
    on_call: Callable[[TesterCall], None] = lambda _call: None
    on_warning: Callable[[CampaignWarning], None] = lambda _warning: None


def conduct(
    search: Search,
    evaluator: Evaluator,
    journal: Journal,
    *,
    trace_address: Callable[[str], str] | None = None,
    confirm: bool = True,
    try_seeds: bool = False,
    watcher: Watcher = Watcher(),  # frozen
) -> CampaignState:
    """Searches, then runs every failure again and groups them.

    Args:
        search: The campaign.
        evaluator: Must have no other user meanwhile; the caller closes it.
        journal: Record of the campaign; its evaluations are replayed first.
        trace_address: Returns where the trace of a failure, by its name, is written; ``None``: they
            are not kept.
        confirm: Whether failures are run again.
        try_seeds: Whether the seed scenarios are run as they are, too, outside the budget.
        watcher: Callbacks.

    Returns:
        ``finished``, ``paused`` or ``cancelled``.

    Raises:
        CampaignError: It cannot continue, or does not match the journal.
        PluginError: The tester raised.
        SearchError: The tester violated its protocol.
    """
    warnings = WarningWatch(watcher.on_warning)

    def see(told: Told) -> None:
        warnings.see_evaluation(told)
        watcher.on_told(told)

    seeds: SeedTrial | None = None
    if try_seeds:
        evaluator = seeds = SeedTrial(search, evaluator, journal, on_seed=warnings.see_seed)
        seeds.begin()
    engine = Engine(
        search,
        evaluator,
        journal,
        requested=watcher.requested,
        on_told=see,
        on_call=watcher.on_call,
    )
    request = engine.run()
    if request is CampaignRequest.NONE:
        warnings.end()
        if seeds is not None:
            request = seeds.finish(watcher.requested)
    if request is CampaignRequest.NONE and confirm:
        request = confirm_failures(
            journal,
            evaluator,
            run_prefix=search.run_prefix,
            trace_address=trace_address,
            requested=watcher.requested,
            on_confirmed=watcher.on_confirmed,
        )
    match request:
        case CampaignRequest.PAUSE:
            return CampaignState.PAUSED
        case CampaignRequest.CANCEL:
            return CampaignState.CANCELLED
    group_failures(journal)
    return CampaignState.FINISHED
