"""What a command says at the end of a campaign, and whether the campaign judged anything."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.plugin_table import named_packages
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignCounts, CampaignState
from drivora_service.store.campaigns.missing_results import MissingResult, missing_words

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.cli.runs.run_gates import Gate

_REPEATED = (RunStatus.AGENT_FAILED, RunStatus.PLUGIN_FAILED)
"""Ends of runs that are kept as results, and are not run again when a campaign is resumed."""


def is_unjudged(counts: CampaignCounts) -> bool:
    """Returns whether there were runs, and none of them was judged."""
    return counts.failed > 0 and not counts.judged


def is_undecided(campaign: Campaign, gate: Gate | None) -> bool:
    """Returns whether nothing was judged, and what there is says nothing to a gate either.

    A gate counts runs that the ADS itself ended.
    """
    is_of_ads = all(one.status is RunStatus.AGENT_FAILED for one in campaign.missing_results)
    return is_unjudged(campaign.counts) and (gate is None or not is_of_ads)


def ending_hint(campaign: Campaign, where: str, out: Path | None) -> str:
    """Returns what is to be done after a campaign has stopped; "" if nothing is.

    Args:
        campaign: The campaign.
        where: Its id, and the options with which other commands find it.
        out: The folder that it is written to.
    """
    counts, missing = campaign.counts, campaign.missing_results
    folder = "" if out is None else f" --out {shlex.quote(str(out))}"
    resume = f"{campaign.state}; resume it with: drivora campaign resume {where}{folder}"
    match campaign.state:
        case CampaignState.FINISHED if is_unjudged(counts):
            return unjudged_hint("campaign", counts, missing)
        case CampaignState.FAILED if is_unjudged(counts) and _is_repeated(missing):
            return unjudged_hint("campaign", counts, missing)
        case CampaignState.FAILED if named_packages(campaign.message):
            return f"failed; {_repair([campaign.message], missing)}, and run the campaign again"
        case CampaignState.PAUSED | CampaignState.FAILED | CampaignState.INTERRUPTED:
            return resume
    return ""


def unjudged_hint(what: str, counts: CampaignCounts, missing: Sequence[MissingResult]) -> str:
    """Returns that nothing was judged, why, and what is to be done.

    Args:
        what: ``campaign`` or ``study``.
        counts: Its counts.
        missing: Why its runs have no result.
    """
    repair = _repair([one.message for one in missing], missing)
    return (
        f"nothing was judged: {missing_words(counts.failed, missing)}\n"
        f"{repair}, and run the {what} again: resuming it does not repeat these runs"
    )


def _is_repeated(missing: Sequence[MissingResult]) -> bool:
    return all(one.status in _REPEATED for one in missing)


def _repair(messages: Sequence[str], missing: Sequence[MissingResult]) -> str:
    """Returns what is to be repaired, as far as messages name it."""
    packages = dict.fromkeys(name for message in messages for name in named_packages(message))
    if packages:
        few = "package" if len(packages) == 1 else "packages"
        listed = ", ".join(map(repr, packages))
        return f"repair or uninstall the {few} {listed} (pip uninstall {' '.join(packages)})"
    if missing and all(one.status is RunStatus.AGENT_FAILED for one in missing):
        return "repair the ADS"
    return "remove the cause"
