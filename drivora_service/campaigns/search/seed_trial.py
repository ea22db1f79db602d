"""The seed scenarios of a campaign, each run once as it is, beside the search.

A campaign whose seed fails without any change says little about what its tester adds. The runs are
outside the budget, and the tester does not learn of them, so that a campaign with them is the same
as one without.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from drivora_service.campaigns.evaluator import Answer, Evaluator
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.engine import Search
from drivora_service.campaigns.search.evaluation_judging import violations_of
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignRequest
from drivora_service.store.campaigns.seed_run_records import SeedRun

MOST_SEEDS = 20
"""Number of seed scenarios that are tried, the first of a campaign: with many of them, the campaign
itself shows soon which fail."""

_POLL_S = 0.5
_LOST = frozenset({RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED})


class SeedTrial:
    """An evaluator that also runs the seed scenarios, and keeps what it learns of them.

    Their runs are submitted first, under negative numbers, and never returned by :meth:`wait`. So
    no worker idles for them.
    """

    def __init__(
        self,
        search: Search,
        evaluator: Evaluator,
        journal: Journal,
        *,
        on_seed: Callable[[SeedRun], None] = lambda _run: None,
    ) -> None:
        """Creates the trial; :meth:`begin` submits the runs.

        Args:
            search: The campaign.
            evaluator: Runs the seeds, and everything that is submitted here.
            journal: Record of the campaign; seeds whose runs it has are not run again.
            on_seed: Called with the run of each seed, also with those of the journal.
        """
        self._search, self._evaluator, self._journal = search, evaluator, journal
        self._on_seed = on_seed
        self._known = {run.place: run for run in journal.seed_runs()}
        self._open: set[int] = set()

    def begin(self) -> None:
        """Submits the runs of the seeds that the journal does not have."""
        for run in self._known.values():
            self._on_seed(run)
        places = [
            place
            for place in range(min(len(self._search.parts), MOST_SEEDS))
            if place not in self._known
        ]
        self._open.update(places)
        if places:
            self._evaluator.submit([(_number(place), self._spec(place)) for place in places])

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues runs, each under its number; first in, first out."""
        self._evaluator.submit(runs)

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call that are not of seeds."""
        answers = self._evaluator.wait(timeout)
        seeds = [answer for answer in answers if answer.number < 0]
        if not seeds:
            return answers
        for answer in seeds:
            self._take(answer)
        return tuple(answer for answer in answers if answer.number >= 0)

    def finish(self, requested: Callable[[], CampaignRequest]) -> CampaignRequest:
        """Waits for the runs of seeds that have not ended.

        Args:
            requested: Returns a pending request to stop.

        Returns:
            The request that ended the waiting, or none.
        """
        while self._open:
            request = requested()
            if request is not CampaignRequest.NONE:
                return request
            self.wait(_POLL_S)
        return CampaignRequest.NONE

    def close(self) -> None:
        """Cancels the runs in flight and releases all resources; may be called again."""
        self._evaluator.close()

    def _spec(self, place: int) -> RunSpec:
        part = self._search.parts[place]
        return RunSpec(
            run_id=f"{self._search.run_prefix}-seed-{place}", document=part.candidates.source.seed
        )

    def _take(self, answer: Answer) -> None:
        place = -1 - answer.number
        self._open.discard(place)
        if answer.report.status in _LOST:
            # It says nothing about the seed, and the campaign does not need it.
            return
        self._known[place] = run = self._seed_run(place, answer.report)
        self._journal.keep_seed_runs(tuple(self._known[key] for key in sorted(self._known)))
        self._on_seed(run)

    def _seed_run(self, place: int, report: RunReport) -> SeedRun:
        return SeedRun(
            place=place,
            name=self._search.seed_names[place] if self._search.seed_names else "",
            run_id=report.run_id,
            status=report.status,
            failures=violations_of(report, self._search.definition),
            error=report.failure,
            sim_time_s=report.sim_time_s,
            wall_time_s=report.wall_time_s,
        )


def _number(place: int) -> int:
    return -1 - place
