"""Studies as commands print them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from drivora_service.api.schemas.studies import Study, StudyInList
from drivora_service.cli.campaigns.campaign_warning_text import print_warning
from drivora_service.cli.terminal.output import print_table, say
from drivora_service.shapes import adapter
from drivora_service.store.campaigns.campaign_records import CampaignState, CampaignSummary
from drivora_service.store.campaigns.missing_results import missing_words
from drivora_service.visible_text import visible_text


def study_content(study: Study, campaigns: Sequence[CampaignSummary]) -> dict[str, Any]:
    """Returns the printed form of a study: as the API shows it, with a list of its campaigns."""
    told: dict[str, Any] = adapter(Study).dump_python(study, mode="json")
    listed = adapter(tuple[CampaignSummary, ...]).dump_python(tuple(campaigns), mode="json")
    return {**told, "campaign_list": listed}


def print_studies(studies: Sequence[StudyInList]) -> None:
    """Prints a row a study."""
    print_table(
        "",
        ("id", "name", "state", "campaigns", "runs", "failing"),
        (
            (
                study.id,
                study.name,
                study.state,
                f"{study.campaigns.get(CampaignState.FINISHED, 0)}/{sum(study.campaigns.values())}",
                f"{study.simulations}/{study.budget}",
                str(study.counts.violating),
            )
            for study in studies
        ),
        cut=("name",),
    )


def print_study(study: Study, campaigns: Sequence[CampaignSummary]) -> None:
    """Prints one study at length: a row for each scenario, agent and method."""
    counts = study.counts
    say(f"Study {study.id} ({study.name}): {study.state}")
    states = ", ".join(
        f"{study.campaigns[state]} {state}" for state in CampaignState if study.campaigns.get(state)
    )
    say(f"  {sum(study.campaigns.values())} campaigns: {states}")
    say(
        f"  {study.simulations} of {study.budget} simulations; {counts.invalid} candidates "
        f"invalid, {missing_words(counts.failed, study.missing_results)}"
    )
    avoidable = f"; {counts.avoidable} of them avoidable" if counts.at_fault else ""
    say(f"  {counts.violating} failing ({counts.at_fault} at fault{avoidable})")
    rows = [*_rows(campaigns)]
    say()
    print_table(
        "By scenario and agent: all repetitions together",
        ("method", "campaigns", "runs", "failing", "at fault", "avoidable"),
        [row[1:] for row in rows],
        headings=[row[0] for row in rows],
    )
    for warning in study.warnings:
        print_warning(warning)
    for campaign in campaigns:
        if campaign.state is CampaignState.FAILED:
            name = visible_text(campaign.name)
            say(f"campaign {campaign.id} ({name}) has failed: {campaign.message}")


def _rows(campaigns: Sequence[CampaignSummary]) -> Iterable[Sequence[str]]:
    """Yields the place, the method, and the counts of every combination, in the file's order."""
    cells: dict[tuple[str, str, str], list[CampaignSummary]] = {}
    # The newest come first; those of the first repetition, which were made first, have every
    # combination in its order.
    for campaign in reversed(campaigns):
        if campaign.cell is not None:
            cell = campaign.cell
            cells.setdefault((cell.scenario, cell.agent, cell.method), []).append(campaign)
    for (scenario, agent, method), here in cells.items():
        finished = sum(one.state is CampaignState.FINISHED for one in here)
        yield (
            f"{scenario}, {agent}",
            method,
            f"{finished}/{len(here)}",
            f"{sum(one.simulations for one in here)}/{sum(one.budget for one in here)}",
            str(sum(one.counts.violating for one in here)),
            str(sum(one.counts.at_fault for one in here)),
            str(sum(one.counts.avoidable or 0 for one in here)),
        )
