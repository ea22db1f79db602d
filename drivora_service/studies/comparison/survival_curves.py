"""Simulations until a repetition has found so many kinds of targets, as survival curves.

A curve is the estimate of Kaplan and Meier (1958) of the share of repetitions that have not found
the k-th kind after so many simulations. A repetition that never finds it is censored at the end of
its observation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from drivora_service.studies.campaign_figures import CampaignFigures

KINDS = (1, 2, 3, 5)
"""Numbers of kinds with curves, as far as a repetition has found so many."""

_HALF = 0.5 + 1e-9
"""Half, above the rounding of a product of shares."""

Figures = TypeVar("Figures", bound=CampaignFigures)


@dataclass(frozen=True, slots=True, kw_only=True)
class Survival:
    """The repetitions of a method at one place that have not found the k-th kind of target.

    Attributes:
        scenario: Name of the scenario.
        agent: Name of the agent; "" where agents are not told apart.
        kinds: k, the number of kinds.
        repetitions: Number of repetitions.
        events: Repetitions that found the k-th kind.
        median: Fewest simulations after which at most half of the repetitions, by the curve, have
            not found it; ``None``: there are none.
        at: Numbers of simulations, ascending: 0, every step of the curve, and the last observed.
        share: Share of the repetitions that have not found it after so many simulations.
    """

    scenario: str
    agent: str
    method: str
    kinds: int
    repetitions: int
    events: int
    median: int | None
    at: tuple[int, ...]
    share: tuple[float, ...]


def kinds_reached(figures: Sequence[CampaignFigures]) -> tuple[int, ...]:
    """Returns the numbers of kinds with curves: the first, and those that a repetition reached."""
    most = max((len(one.found_avoidable) for one in figures), default=0)
    return tuple(kinds for kinds in KINDS if kinds <= max(most, 1))


def survival_curves(
    figures: Sequence[Figures], *, agent_of: Callable[[Figures], str] = lambda _figures: ""
) -> tuple[Survival, ...]:
    """Computes the curves of every method at every place.

    Args:
        figures: Figures of campaigns.
        agent_of: Returns the name of the agent where curves are computed for each agent.

    Returns:
        The curves by number of kinds, then scenario, agent and method in the order of the figures.
    """
    places: dict[tuple[str, str], dict[str, list[Figures]]] = {}
    for one in figures:
        methods = places.setdefault((one.scenario, agent_of(one)), {})
        methods.setdefault(one.method, []).append(one)
    return tuple(
        _survival(repetitions, kinds, scenario, agent, method)
        for kinds in kinds_reached(figures)
        for (scenario, agent), methods in places.items()
        for method, repetitions in methods.items()
    )


def _survival(
    repetitions: Sequence[CampaignFigures], kinds: int, scenario: str, agent: str, method: str
) -> Survival:
    found = [f.found_avoidable[kinds - 1] for f in repetitions if len(f.found_avoidable) >= kinds]
    never = [_observation_end(f) for f in repetitions if len(f.found_avoidable) < kinds]
    at, share = kaplan_meier(found, never)
    below = np.flatnonzero(np.array(share) <= _HALF)
    last = max(map(_observation_end, repetitions))
    if last > at[-1]:
        at, share = (*at, last), (*share, share[-1])
    return Survival(
        scenario=scenario,
        agent=agent,
        method=method,
        kinds=kinds,
        repetitions=len(repetitions),
        events=len(found),
        median=at[below[0]] if len(below) else None,
        at=at,
        share=share,
    )


def kaplan_meier(
    events: Sequence[int], censored: Sequence[int]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Estimates the share that has no event after a time, from censored observations.

    Args:
        events: Times of events.
        censored: Times until which others were observed without one. One that was censored at the
            time of an event was still observed at it.

    Returns:
        0 and the times with events, and the share after each.
    """
    happened = np.array(events, dtype=np.int64)
    times = np.concatenate([happened, np.array(censored, dtype=np.int64)])
    steps, counts = np.unique(happened, return_counts=True)
    observed = (times[None, :] >= steps[:, None]).sum(axis=1)
    share = np.cumprod(1.0 - counts / observed)
    return (0, *steps.tolist()), (1.0, *share.tolist())


def _observation_end(figures: CampaignFigures) -> int:
    """Returns the number of simulations until which a campaign was observed.

    One that ended before its budget would have found nothing more: it is observed until the budget.
    At equal time there is no budget, but only what it had done within the limit.
    """
    if figures.time_limit_s is not None:
        return figures.simulations
    return max(figures.simulations, figures.budget or 0)
