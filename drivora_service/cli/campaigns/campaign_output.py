"""Campaigns as commands print them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drivora_service.api.schemas.campaigns import Campaign, Evaluation, Failure
from drivora_service.cli.campaigns.campaign_warning_text import print_warning
from drivora_service.cli.runs.run_output import follow_up
from drivora_service.cli.terminal.output import number, print_table, say
from drivora_service.oracles.verdicts.accountability import IN_WORDS, accountability
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition
from drivora_service.oracles.verdicts.failure_facts import full_message
from drivora_service.shapes import adapter
from drivora_service.store.campaigns.campaign_records import (
    CampaignCounts,
    EvaluationSummary,
)
from drivora_service.store.campaigns.missing_results import missing_words
from drivora_service.visible_text import visible_text

_SHOWN = 40
"""Evaluations of a lineage in a table."""


def campaign_content(campaign: Campaign, failures: Sequence[Failure]) -> dict[str, Any]:
    """Returns the printed form of a campaign: as the API shows it, with its failures."""
    told: dict[str, Any] = adapter(Campaign).dump_python(campaign, mode="json")
    listed = adapter(tuple[Failure, ...]).dump_python(tuple(failures), mode="json")
    return {**told, "failures": listed}


def print_campaigns(campaigns: Sequence[Campaign]) -> None:
    """Prints a row a campaign."""
    print_table(
        "",
        ("id", "name", "state", "tester", "runs", "failing", "counts"),
        (
            (
                campaign.id,
                campaign.name,
                campaign.state,
                campaign.tester,
                f"{campaign.simulations}/{campaign.budget}",
                str(campaign.counts.violating),
                _counts(campaign.definition),
            )
            for campaign in campaigns
        ),
        cut=("name",),
    )


def print_campaign(campaign: Campaign, *, where: str = "") -> None:
    """Prints one campaign at length.

    Args:
        campaign: The campaign.
        where: Options with which other commands find it.
    """
    counts = campaign.counts
    say(f"Campaign {campaign.id} ({visible_text(campaign.name)}): {campaign.state}")
    if campaign.message:
        say(f"  {campaign.message}")
    say(f"  {campaign.tester} against {campaign.configuration} on {campaign.town}")
    if (start := campaign.document["tester"].get("start_from")) is not None:
        say(f"  Started from {len(start['candidates'])} {start['kind']} of {start['source']}")
    say(
        f"  {campaign.simulations} of {campaign.budget} simulations in {campaign.active_s:.0f} s "
        f"({number(campaign.rate, 2)} a second); {counts.invalid} candidates invalid, "
        f"{missing_words(counts.failed, campaign.missing_results)}"
    )
    say(f"  {counts.violating} failing ({_accountable(counts)})")
    if counts.apart:
        apart = ", ".join(f"{number} {words}" for number, words in counts.apart)
        say(f"  Simulations by their strongest violation, counted or not: {apart}")
    say(f"  Failures are {campaign.definition.words}")
    for warning in campaign.warnings:
        print_warning(warning)
    if campaign.seeds:
        _print_seeds(campaign)
    if campaign.kinds:
        print_table(
            "Failures",
            (
                "kind",
                "runs",
                "violations",
                "at fault",
                "avoidable",
                "confirmed",
                "flaky",
                "groups",
                "first",
            ),
            (
                (
                    kind.kind.replace("|", " | "),
                    str(kind.failures),
                    str(kind.violations),
                    str(kind.at_fault),
                    str(kind.avoidable),
                    str(kind.confirmed),
                    str(kind.flaky),
                    "-" if kind.groups is None else str(kind.groups),
                    f"#{kind.first}",
                )
                for kind in campaign.kinds
            ),
        )
        first = min(kind.first for kind in campaign.kinds)
        commands = follow_up(f"{campaign.id}-{first}", where)
        say(f"The run of evaluation #N is {campaign.id}-N: {commands}")


def _print_seeds(campaign: Campaign) -> None:
    print_table(
        "Seed scenarios",
        (
            "name",
            "network",
            "runs",
            "failing",
            "at fault",
            "avoidable",
            "kinds",
            "first",
            "first avoidable",
        ),
        (
            (
                seed.name,
                seed.town,
                str(seed.simulations),
                str(seed.violating),
                str(seed.at_fault),
                str(seed.avoidable),
                str(seed.kinds),
                "-" if seed.first_failure is None else f"#{seed.first_failure}",
                "-" if seed.first_avoidable is None else f"#{seed.first_avoidable}",
            )
            for seed in campaign.seeds
        ),
        cut=("name",),
    )


def _counts(definition: StatedDefinition) -> str:
    """Returns what counts in a word, and how many oracles if not all but observations do."""
    oracles = definition.oracles
    named = "" if oracles is None else f", {len(oracles)} oracle{'' if len(oracles) == 1 else 's'}"
    return f"{definition.counts or '-'}{named}"


def _accountable(counts: CampaignCounts) -> str:
    parts = [f"{counts.at_fault} at fault"]
    if counts.avoidable is not None:
        parts.append(f"{counts.avoidable} avoidable")
    return ", ".join(parts)


def print_evaluation(evaluation: Evaluation, *, where: str = "") -> None:
    """Prints an evaluation and the nearest of its ancestors.

    Args:
        evaluation: The evaluation.
        where: Options with which other commands find it.
    """
    say(f"Evaluation {evaluation.number}: {evaluation.status}")
    for ego in evaluation.privileged:
        say(f"  {ego} sees everything, not only what the perception model lets through")
    if evaluation.error is not None:
        say(f"  {evaluation.error.cause}: {evaluation.error.message}")
    for verdict in evaluation.failures:
        words = IN_WORDS[accountability(verdict)]
        fault = f", {words}" if words else ""
        ego = f" of {verdict.ego}" if len(evaluation.agents) > 1 else ""
        say(f"  {verdict.oracle}{ego} at {number(verdict.time)} s{fault}: {full_message(verdict)}")
    if evaluation.failures:
        say(f"  Run {evaluation.run_id}: {follow_up(evaluation.run_id, where)}")
    if evaluation.objectives:
        objectives = evaluation.objectives.items()
        say("  " + ", ".join(f"{name} {number(value, 3)}" for name, value in objectives))
    ancestors: tuple[EvaluationSummary, ...] = evaluation.lineage
    print_table(
        "Lineage",
        ("evaluation", "generation", "origin", "parents", "status", "failures"),
        (
            (
                f"#{member.number}",
                str(member.generation),
                member.origin,
                ", ".join(f"#{parent}" for parent in member.parents) or "-",
                str(member.status),
                str(member.violations),
            )
            for member in (*ancestors[1 - _SHOWN :], evaluation)
        ),
        wrap=("parents",),
    )
    if len(ancestors) >= _SHOWN:
        say(f"{len(ancestors) + 1 - _SHOWN} earlier ancestors; --json prints them as well")
