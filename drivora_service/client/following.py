"""Following batches, campaigns, studies and minimisations until they have ended.

A service tells by events when a look is worth it, see ``waiting``; an application in this process,
and a service without events, is looked at in a pace of its own.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from drivora_service.client.calls import (
    campaigns,
    catalogues,
    jobs,
    minimizations,
    runs,
    studies,
)
from drivora_service.client.flows import Emit, Flow, Items, Sleep, Terms, perform_call
from drivora_service.client.waiting import Waiting
from drivora_service.errors import ServiceUnavailable

if TYPE_CHECKING:
    from drivora_service.api.schemas.batches import Batch
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.api.schemas.runs import Run
    from drivora_service.api.schemas.studies import Study
    from drivora_service.client.call import Call
    from drivora_service.store.changes.change_lists import ChangedKind

T = TypeVar("T")

_SHORTEST_S, _LONGEST_S = 0.1, 2.0
_LOCAL_SHARE, _LOCAL_SHORTEST_S, _LOCAL_LONGEST_S = 0.05, 0.05, 0.25
"""The wait between two looks at an application in this process: a share of the time since the first
look, within bounds. A look takes a few milliseconds of the processor that the workers use."""
_LOCAL_STILL_S = 0.5
"""Seconds between two questions whether workers can begin runs, to such an application."""
_GROWTH = 1.5


class _Pace:
    """The waits between two polls: short while the state changes, longer while it does not."""

    def __init__(self, *, is_local: bool) -> None:
        self._is_local = is_local
        self._wait_s = _SHORTEST_S
        self._began_at = self._looked_at = self._asked_at = time.monotonic()
        self._seen: object = None

    def look(self) -> None:
        """Notes that a look begins."""
        self._looked_at = time.monotonic()

    def is_still(self, seen: object) -> bool:
        """Returns whether nothing has changed for a while, so that a fault may be the cause."""
        changed, self._seen = seen != self._seen, seen
        self._wait_s = _SHORTEST_S if changed else _GROWTH * self._wait_s
        if changed or (self._is_local and self._looked_at < self._asked_at + _LOCAL_STILL_S):
            return False
        self._asked_at = self._looked_at
        return True

    @property
    def looked_s(self) -> float:
        """Seconds since the last look began."""
        return time.monotonic() - self._looked_at

    def wait(self, retry_after_s: float | None) -> Sleep:
        """Returns the wait before the next look.

        Args:
            retry_after_s: After which the service says that looking is worth it: the bound of the
                waits that grow, not their beginning, as what changes may end at any time.
        """
        now = time.monotonic()
        if self._is_local:
            share = _LOCAL_SHARE * (now - self._began_at)
            return Sleep(min(max(share, _LOCAL_SHORTEST_S), _LOCAL_LONGEST_S))
        bound = min(max(retry_after_s or _LONGEST_S, _SHORTEST_S), _LONGEST_S)
        self._wait_s = min(self._wait_s, bound)
        # Looks at a large batch take time, and shall not take all of it.
        return Sleep(min(max(self._wait_s, now - self._looked_at), _LONGEST_S))


def check_workers(terms: Terms) -> Flow[None]:
    """Checks that the service can begin runs.

    Raises:
        ServiceUnavailable: It cannot, or did not answer.
    """
    readiness = (yield from perform_call(catalogues.readiness(), terms)).value
    for check in readiness.checks:
        if check.name == "workers" and not check.ok:
            message = f"{terms.service.name} cannot begin runs: {check.detail}"
            if not terms.service.is_local:
                message += (
                    "\nWhat is queued there stays queued, and begins once the fault is corrected"
                )
            raise ServiceUnavailable(message, status=503)


def watch_batch(batch_id: str, terms: Terms, on_progress: Callable[[Batch], None]) -> Items[Run]:
    """Hands out the runs of a batch as they end, each once, until all have ended.

    Args:
        batch_id: Id of the batch.
        terms: How the service is asked.
        on_progress: Called with the batch at every look.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    from drivora_service.store.changes.change_lists import ChangedKind

    handed_out: set[str] = set()
    pace = _Pace(is_local=terms.service.is_local)
    waiting = Waiting(ChangedKind.BATCH, batch_id, terms)
    yield from waiting.begin()
    while True:
        pace.look()
        answer = yield from perform_call(jobs.batch(batch_id), terms)
        batch = answer.value
        on_progress(batch)
        ended = sum(count for status, count in batch.counts.items() if status.is_final)
        yield from _emit_ended_runs(batch_id, terms, handed_out, most=ended - len(handed_out))
        if batch.done:
            return
        if pace.is_still((batch.counts, batch.state)):
            yield from check_workers(terms)
        yield from waiting.change(pace.wait(answer.retry_after_s), looked_s=pace.looked_s)


def _emit_ended_runs(batch_id: str, terms: Terms, handed_out: set[str], *, most: int) -> Items[Run]:
    """Hands out runs that have ended since the look before: ``most``, and those of the same page.

    The newest jobs come first in the list and are run last, so that what has ended since stands at
    its beginning; the rest of the list is not read.
    """
    from drivora_service.runs.run_report import RunStatus
    from drivora_service.store.runs.run_records import JobFilter

    final = frozenset(status for status in RunStatus if status.is_final)
    listing = jobs.jobs(JobFilter(batch_id=batch_id, statuses=final))
    token: str = ""
    while most > 0:
        page: Any = (yield from perform_call(listing.page(token, taken=0), terms)).value
        for job in page.items:
            if job.id not in handed_out:
                handed_out.add(job.id)
                most -= 1
                yield Emit((yield from perform_call(runs.run(job.id), terms)).value)
        token = page.next_page_token
        if not token:
            return


@dataclass(frozen=True, slots=True, kw_only=True)
class _Watched(Generic[T]):
    """What is watched until it has ended.

    Attributes:
        kind: Of its changes.
        id: Its id.
        call: Asks for it.
        has_ended: Whether watching it is over.
        progress: What changes as long as something is done.
    """

    kind: ChangedKind
    id: str
    call: Call[T]
    has_ended: Callable[[T], bool]
    progress: Callable[[T], object]


def _watch(watched: _Watched[T], terms: Terms, on_progress: Callable[[T], None]) -> Flow[T]:
    pace = _Pace(is_local=terms.service.is_local)
    waiting = Waiting(watched.kind, watched.id, terms)
    yield from waiting.begin()
    while True:
        pace.look()
        answer = yield from perform_call(watched.call, terms)
        on_progress(answer.value)
        if watched.has_ended(answer.value):
            return answer.value
        if pace.is_still(watched.progress(answer.value)):
            yield from check_workers(terms)
        yield from waiting.change(pace.wait(answer.retry_after_s), looked_s=pace.looked_s)


def watch_campaign(
    campaign_id: str, terms: Terms, on_progress: Callable[[Campaign], None]
) -> Flow[Campaign]:
    """Waits until a campaign has ended or is paused, and returns it.

    Args:
        campaign_id: Id of the campaign.
        terms: How the service is asked.
        on_progress: Called with the campaign at every look, the last one included.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    from drivora_service.store.campaigns.campaign_records import CampaignState
    from drivora_service.store.changes.change_lists import ChangedKind

    watched = _Watched(
        kind=ChangedKind.CAMPAIGN,
        id=campaign_id,
        call=campaigns.campaign(campaign_id),
        has_ended=lambda one: one.state not in (CampaignState.QUEUED, CampaignState.RUNNING),
        progress=lambda one: (one.state, one.counts, one.kinds),
    )
    return (yield from _watch(watched, terms, on_progress))


def watch_study(study_id: str, terms: Terms, on_progress: Callable[[Study], None]) -> Flow[Study]:
    """Waits until no campaign of a study runs or waits, and returns the study.

    Args:
        study_id: Id of the study.
        terms: How the service is asked.
        on_progress: Called with the study at every look, the last one included.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    from drivora_service.store.changes.change_lists import ChangedKind

    watched = _Watched(
        kind=ChangedKind.STUDY,
        id=study_id,
        call=studies.study(study_id),
        has_ended=lambda one: not one.state.is_active,
        progress=lambda one: (one.campaigns, one.counts),
    )
    return (yield from _watch(watched, terms, on_progress))


def watch_minimization(
    minimization_id: str, terms: Terms, on_progress: Callable[[Minimization], None]
) -> Flow[Minimization]:
    """Waits until a minimisation has ended, and returns it.

    Args:
        minimization_id: Id of the minimisation.
        terms: How the service is asked.
        on_progress: Called with the minimisation at every look, the last one included.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    from drivora_service.store.changes.change_lists import ChangedKind

    watched = _Watched(
        kind=ChangedKind.MINIMIZATION,
        id=minimization_id,
        call=minimizations.minimization(minimization_id),
        has_ended=lambda one: not one.state.is_active,
        progress=lambda one: (one.state, one.simulations),
    )
    return (yield from _watch(watched, terms, on_progress))
