"""Confirming and grouping the failures after the search."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice

from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.evaluation_judging import refuse_lost
from drivora_service.campaigns.search.failure_grouping import Grouping
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.store.campaigns.campaign_records import CampaignRequest, Confirmation

_POLL_S = 0.5
_AT_ONCE = 1024
"""Runs that are submitted and not answered: more than any machine has workers."""


def confirm_failures(
    journal: Journal,
    evaluator: Evaluator,
    *,
    run_prefix: str,
    trace_address: Callable[[str], str] | None,
    requested: Callable[[], CampaignRequest] = lambda: CampaignRequest.NONE,
    on_confirmed: Callable[[int, Confirmation], None] = lambda _number, _confirmation: None,
) -> CampaignRequest:
    """Repeats the run of every failing scenario that is not confirmed yet, outside the budget.

    A failure is confirmed if the second run's trace is the first one's, step by step.

    Args:
        journal: Journal of a campaign after its search.
        evaluator: Must have no other user meanwhile.
        run_prefix: Prefix of the ids of the runs.
        trace_address: Returns where a trace of a name is written; ``None``: they are not kept.
        requested: Returns a pending request to stop.
        on_confirmed: Called with each number and confirmation.

    Returns:
        The request that ended it, or none.

    Raises:
        CampaignError: A run was lost.
    """
    open_numbers = journal.open_numbers()
    waiting = (one for one in journal.evaluations(violating=True) if one.number in open_numbers)
    expected: dict[int, str] = {}

    def submit() -> None:
        """Submits further runs; not all at once, as each holds its document."""
        new: list[tuple[int, RunSpec]] = []
        for record in islice(waiting, _AT_ONCE - len(expected)):
            number = record.number
            expected[number] = record.report.trace_sha256
            address = "" if trace_address is None else trace_address(trace_name(number))
            run_id = f"{run_prefix}-{number}-again"
            document = journal.document(number)
            new.append((number, RunSpec(run_id=run_id, document=document, trace_path=address)))
        if new:
            evaluator.submit(new)

    submit()
    while expected:
        request = requested()
        if request is not CampaignRequest.NONE:
            return request
        for answer in evaluator.wait(_POLL_S):
            refuse_lost(answer)
            same = _is_same(answer.report, expected.pop(answer.number))
            confirmation = Confirmation.CONFIRMED if same else Confirmation.FLAKY
            kept = trace_address is not None and answer.report.trace_sha256
            trace = trace_name(answer.number) if kept else ""
            journal.confirm(answer.number, confirmation, trace)
            on_confirmed(answer.number, confirmation)
        if len(expected) <= _AT_ONCE // 2:
            submit()
    return CampaignRequest.NONE


def group_failures(
    journal: Journal,
    grouping: Grouping = Grouping(),  # noqa: B008 # frozen
) -> None:
    """Groups the failures of a campaign, without those that were not repeated."""
    failures = [f for f in journal.failures() if f.confirmation is not Confirmation.FLAKY]
    labels = grouping.label([failure.verdict for failure in failures])
    journal.group(
        {(f.evaluation, f.place): label for f, label in zip(failures, labels, strict=True)}
    )


def trace_name(number: int) -> str:
    """Returns the name of the trace of a failing evaluation."""
    return f"{number:06d}.trace.parquet"


def _is_same(report: RunReport, trace_sha256: str) -> bool:
    return bool(trace_sha256) and report.trace_sha256 == trace_sha256
