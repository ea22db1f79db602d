"""What the simulations of each method came to: what counts, and apart from it all else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from drivora_service.studies.campaign_figures import CampaignFigures

COLUMNS = (
    "place",
    "method",
    "simulations",
    "avoidable",
    "not measurable",
    "unavoidable",
    "undetermined",
    "fault not judged",
    "preventable",
    "others' fault",
)

WORDS = (
    "Simulations of all campaigns by the strongest of their failures. What counts is the first "
    "column after their number: the fault of an ego, and avoided by a careful and competent "
    "driver. Then follow those at fault of which the run does not tell whether that driver avoids "
    "it, and those that it does not avoid; violations of undetermined fault, and of oracles that "
    "attribute none; and violations at the fault of others, those that a careful driver of the ego "
    "avoids and the others."
)

F = TypeVar("F", bound=CampaignFigures)


def accountable_rows(
    figures: Iterable[F], place: Callable[[F], str] = lambda one: one.scenario
) -> list[tuple[str, ...]]:
    """Returns a row for each method in each place, in the order of the campaigns.

    Args:
        figures: Figures of campaigns.
        place: Returns the place of a campaign.
    """
    by_place: dict[tuple[str, str], list[CampaignFigures]] = {}
    for one in figures:
        by_place.setdefault((place(one), one.method), []).append(one)
    return [(*names, *map(str, _sums(found))) for names, found in by_place.items()]


def _sums(found: Sequence[CampaignFigures]) -> list[int]:
    counts = [
        (
            one.simulations,
            one.avoidable,
            one.not_measurable,
            one.unavoidable,
            one.undetermined,
            one.not_judged,
            one.preventable,
            one.not_at_fault - one.preventable,
        )
        for one in found
    ]
    return [sum(column) for column in zip(*counts, strict=True)]
