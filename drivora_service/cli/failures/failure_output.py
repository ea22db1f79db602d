"""Failures of all campaigns and batches, and their groups, as commands print them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drivora_service.cli.runs.run_output import follow_up
from drivora_service.cli.terminal.output import print_table, say
from drivora_service.store.failures.group_records import ChangedPart, GroupChange, SinceBaseline

if TYPE_CHECKING:
    from datetime import datetime

    from drivora_service.api.schemas.failure_groups import FailureGroup
    from drivora_service.api.schemas.failures import FoundFailure
    from drivora_service.store.failures.found_counting import FoundCounts


def print_failures(failures: Sequence[FoundFailure], *, where: str = "") -> None:
    """Prints a row a failure below the id of its run, with the ego if there are several."""
    has_egos = len({one.verdict.ego for one in failures}) > 1
    print_table(
        "",
        (
            "failure",
            "group",
            "found at",
            *(("ego",) if has_egos else ()),
            "agent",
            "what happened",
        ),
        [
            (
                str(one.id),
                one.group_id,
                _moment(one.found_at),
                *((one.verdict.ego,) if has_egos else ()),
                one.configuration,
                one.sentence,
            )
            for one in failures
        ],
        wrap=("agent", "what happened"),
        headings=[f"run {one.run_id}" for one in failures],
    )
    if failures:
        say(f"The first of these runs: {follow_up(failures[0].run_id, where)}")


def print_counts(counts: FoundCounts) -> None:
    """Prints the numbers of all failures, and what they count."""
    runs = "" if counts.runs is None else f" in {counts.runs} runs"
    parts = [f"{counts.avoidable} at fault and avoidable"]
    if counts.preventable:
        parts.append(f"{counts.preventable} not at fault, but avoidable")
    say(f"{counts.failures} failures{runs}; {', '.join(parts)}")
    if counts.agent_failed_runs:
        number = counts.agent_failed_runs
        say(
            f"and {number} run{'' if number == 1 else 's'} in which the ADS failed, which "
            f"{'is a failure, too; it is' if number == 1 else 'are failures, too; they are'} "
            "not listed here"
        )
    if counts.definition is not None:
        say(f"failures are {counts.definition.words}")
    else:
        say("failures are what each suite, campaign or request defined, see --counts")


def print_groups(groups: Sequence[FailureGroup]) -> None:
    """Prints a row a group, and how many are new, the same and gone since a baseline."""
    compared = any(one.since_baseline for one in groups)
    print_table(
        "",
        (
            "group",
            "status",
            *(("since",) if compared else ()),
            "failures",
            "avoidable",
            "last seen",
            "assignee",
            "what",
        ),
        [
            (
                one.id,
                "fixed, back" if one.is_back else one.status.replace("_", " "),
                *((one.since_baseline or "",) if compared else ()),
                str(one.failures),
                str(one.avoidable),
                _moment(one.last_seen),
                one.assignee,
                _title(one),
            )
            for one in groups
        ],
        wrap=("what",),
    )
    if compared:
        numbers = [
            f"{sum(one.since_baseline is since for one in groups)} {since}"
            for since in SinceBaseline
        ]
        say(f"since the baseline: {', '.join(numbers)}")


def print_group(group: FailureGroup, changes: Sequence[GroupChange]) -> None:
    """Prints a group and what was decided about it, the last first."""
    print_groups((group,))
    say(group.sentence)
    if group.note:
        say(group.note)
    for change in changes:
        say(f"{_moment(change.at)} {change.by or 'someone'}: {_describe_change(change)}")


def _title(group: FailureGroup) -> str:
    return group.label or "; ".join(group.names)


def _describe_change(change: GroupChange) -> str:
    match change.what:
        case ChangedPart.MERGED:
            return f"merged {change.after} into it"
        case ChangedPart.SPLIT:
            if change.after:
                return f"split it off {change.before}"
            return f"split {change.before} off"
        case what:
            return f"{what} {change.before or '(none)'} → {change.after or '(none)'}"


def _moment(time: datetime) -> str:
    return f"{time.astimezone():%Y-%m-%d %H:%M}"
