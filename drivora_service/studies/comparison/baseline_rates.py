"""Notes on comparisons whose baseline fails too rarely or too often to tell methods apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.failure_rates import TOO_FREQUENT, TOO_RARE, FailureRate, percent

F = TypeVar("F", bound=CampaignFigures)


def baseline_notes(
    figures: Sequence[F], baseline: str, place_of: Callable[[F], str]
) -> Iterator[str]:
    """Yields a note for each place where the baseline's simulations hardly ever, or mostly, fail.

    Args:
        figures: Figures of all campaigns.
        baseline: Name of the method that the others are compared with.
        place_of: Returns the place where a campaign is compared: its seed scenario, perhaps with
            its agent.
    """
    for place in dict.fromkeys(map(place_of, figures)):
        here = [one for one in figures if place_of(one) == place]
        own = [one for one in here if one.method == baseline]
        if not own or len(own) == len(here):
            continue
        rate = FailureRate(
            failing=sum(one.failing for one in own), simulations=sum(one.simulations for one in own)
        )
        if rate.is_too_rare:
            yield (
                f"{place}: {baseline} fails in {rate}, under {percent(TOO_RARE)}: the comparison "
                "tells little here, since hardly any simulation fails. Give the campaigns more "
                "simulations, or take another scene or space; `drivora seeds rate` tells how often "
                "random scenarios of a scene fail"
            )
        elif rate.is_too_frequent:
            yield (
                f"{place}: {baseline} fails in {rate}, over {percent(TOO_FREQUENT)}: the "
                "comparison tells little here, since no method can find many more failures. Take "
                "another scene or space, or count fewer violations; `drivora seeds rate` tells how "
                "often random scenarios of a scene fail"
            )
