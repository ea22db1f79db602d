"""Confirming and grouping the failures after the search."""

from __future__ import annotations

from collections.abc import Callable

from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.evaluation_judging import refuse_lost
from drivora_service.campaigns.search.failure_grouping import Grouping
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.store.campaigns.campaign_records import CampaignRequest, Confirmation

_POLL_S = 0.5


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
    open_numbers = {f.evaluation for f in journal.failures() if f.confirmation is Confirmation.OPEN}
    expected: dict[int, str] = {}
    for record in journal.evaluations(violating=True):
        if record.number in open_numbers:
            expected[record.number] = record.report.trace_sha256
    evaluator.submit(
        [
            (
                number,
                RunSpec(
                    run_id=f"{run_prefix}-{number}-again",
                    document=journal.document(number),
                    trace_path="" if trace_address is None else trace_address(trace_name(number)),
                ),
            )
            for number in expected
        ]
    )
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
