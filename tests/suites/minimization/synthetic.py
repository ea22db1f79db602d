"""Scenarios that fail by a rule on their documents, and a minimiser that is answered by it."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import cache
from typing import Any

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.minimization.edits import content_of
from drivora_service.suites.minimization.minimizer import Minimizer, Trial, TrialResult
from drivora_service.suites.minimization.proposal_checking import Checker
from drivora_service.suites.minimization.reduction_search import Reductions
from drivora_service.suites.minimization.shortening import Failure

Content = dict[str, Any]
Rule = Callable[[Content], bool]
"""Returns whether the content of a document fails in the same way."""

PLACE = (11.77, 40.0)
"""On the route of the ego of the synthetic scenario."""


@cache
def checker() -> Checker:
    """The checker of this installation; shared, since it keeps what it has checked."""
    return Checker(NetworkCatalogue(shipped_networks()), AgentCatalogue().availability())


def minimizer(document: ScenarioDocument, *, budget: int = 10_000) -> Minimizer:
    """A minimiser of a document whose first ego fails."""
    check = checker()
    reductions = Reductions(ego=document.ego_vehicles[0].id, network=check.network_of(document))
    return Minimizer(document, check=check, reductions=reductions, budget=budget)


def answered(
    made: Minimizer,
    rule: Rule,
    *,
    workers: int = 1,
    luck: random.Random | None = None,
    told: dict[str, TrialResult] | None = None,
    most: int | None = None,
) -> dict[str, TrialResult]:
    """Answers a minimiser until it is over, or ``most`` trials were made.

    Args:
        made: The minimiser.
        rule: Which documents fail.
        workers: Trials at once.
        luck: Chooses which of them ends first; ``None``: the first one does.
        told: Results that are known already, by the keys of their trials.
        most: Greatest number of trials.

    Returns:
        All results by the keys of their trials.
    """
    results = dict(told or {})
    running: dict[str, Trial] = {}
    while not made.is_over:
        for trial in made.choose_trials(workers):
            if trial.key in results:
                made.tell(trial.key, results[trial.key])
                break
            if len(running) < workers:
                running.setdefault(trial.key, trial)
        else:
            if most is not None and len(results) >= most:
                return results
            key = next(iter(running)) if luck is None else luck.choice(sorted(running))
            trial = running.pop(key)
            results[key] = result_of(trial, rule)
            made.tell(key, results[key])
            continue
        running = {key: trial for key, trial in running.items() if key not in results}
    return results


def result_of(trial: Trial, rule: Rule) -> TrialResult:
    """The result of a trial by a rule; it fails after 8 s, and ends after 60 s."""
    document = trial.checked.document
    ends = min(60.0, document.max_sim_time or 60.0)
    fails = rule(dict(content_of(document))) and ends > 8.0
    failure = Failure(time=8.0, location=PLACE, sim_time_s=ends) if fails else None
    return TrialResult(failure=failure)
