"""From a validated campaign to a search that is ready to run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version

import numpy as np

from drivora_service.campaigns.document.campaign import FeedbackMode
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import ValidCampaign
from drivora_service.campaigns.document.start_checks import read_starts
from drivora_service.campaigns.search.engine import Search
from drivora_service.campaigns.search.failure_kinds import FailureKinds
from drivora_service.campaigns.search.seed_turns import SearchPart
from drivora_service.campaigns.search.tester_calls import TesterCall, called
from drivora_service.campaigns.search.warm_start import ShiftedCheckpoints, WarmStart
from drivora_service.errors import InvalidDocument, NetworkError, Problem, SearchError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.planned_motion import PlannedMotion
from drivora_service.plugin_table import describe_plugin
from drivora_service.scenario.model import NpcBehavior, Scenario
from drivora_service.search.aims import aims_of
from drivora_service.search.candidate_space import CandidateSpace, OwnSpace
from drivora_service.search.catalogue import make_components
from drivora_service.search.space.own_space import make_space
from drivora_service.search.space.space_candidates import ScenarioCandidates
from drivora_service.search.tester import (
    Checkpoints,
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)

_SEARCH, _SHUFFLE = 0, 1
"""Streams of random numbers that derive from a campaign's seed."""


class ShuffledFeedback:
    """Tells a tester, for each candidate, the results of one of the candidates judged so far.

    It is drawn uniformly, the candidate itself included, so that the tester sees results that are
    distributed as its own. Whether a candidate is valid is not changed, nor which of its genes
    had no effect: mutants are drawn again as with feedback, so that the twin differs in nothing but
    the feedback.
    """

    def __init__(self, tester: Tester, random: np.random.Generator) -> None:
        self._tester, self._random = tester, random
        self._judged: list[Evaluation] = []

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Asks the tester."""
        return self._tester.ask(room)

    def tell(self, evaluation: Evaluation) -> None:
        """Tells the tester the results of another candidate."""
        if evaluation.status is EvaluationStatus.JUDGED:
            self._judged.append(evaluation)
            other = self._judged[int(self._random.integers(len(self._judged)))]
            evaluation = replace(
                evaluation,
                violations=other.violations,
                verdicts=other.verdicts,
                scores=other.scores,
                measurement=other.measurement,
            )
        self._tester.tell(evaluation)


def prepare_search(
    valid: ValidCampaign,
    catalogues: Catalogues,
    *,
    run_prefix: str,
    checkpoints: Checkpoints | None = None,
    on_call: Callable[[TesterCall], None] = lambda _call: None,
) -> Search:
    """Builds the search of a campaign: its gene space and its tester.

    The same campaign always gives the same search.

    Args:
        valid: The campaign.
        catalogues: Catalogues for its names.
        run_prefix: Prefix of the ids of the runs.
        checkpoints: Place for checkpoints of the tester; unused with several seed scenarios, since
            it numbers the evaluations of one tester.
        on_call: Called when a tester is going to be made, and with ``NONE`` afterwards.

    Raises:
        InvalidDocument: The gene space cannot be built, or the tester cannot search it.
    """
    campaign = valid.campaign
    plugin = catalogues.testers.plugin(campaign.tester.name)
    space_of = campaign.space
    drives_by_sumo = not isinstance(space_of, OwnSpace) and space_of.behavior is NpcBehavior.SUMO
    if plugin.compares_paths and drives_by_sumo:
        message = (
            f"found 'sumo'; tester {plugin.name!r} keeps actors out of the way of the egos, and "
            "where SUMO drives them is not known before: use 'replay' or 'reactive'"
        )
        raise InvalidDocument(
            (Problem(pointer="/space/behavior", code="unplanned_motion", message=message),)
        )
    agents = frozenset(catalogues.agents.names())
    parts = []
    for place, seed in enumerate(valid.seeds):
        named = f"seed scenario {seed.name!r}: " if seed.name else ""
        try:
            space = make_space(seed.scenario, seed.network, campaign.space)
        except (SearchError, NetworkError) as error:
            raise _refusal("/space", "space", named, error) from error
        try:
            starts = read_starts(valid.document, seed.name, space.genes)
            kept = checkpoints if len(valid.seeds) == 1 else None
            if kept is not None and starts:
                kept = ShiftedCheckpoints(kept, len(starts))
            with called(on_call, TesterCall.MAKE):
                tester = _tester(valid, catalogues, space, place, kept)
            if starts:
                tester = WarmStart(tester, starts, space.genes)
        except SearchError as error:
            raise _refusal("/tester", "tester", named, error) from error
        parts.append(
            SearchPart(
                tester=tester,
                candidates=ScenarioCandidates(
                    space=space,
                    networks=catalogues.networks,
                    agents=agents,
                    motions=_planned_motions,
                ),
                kind_of=FailureKinds(seed.network),
            )
        )
    return Search(
        run_prefix=run_prefix,
        parts=tuple(parts),
        feedback=replace(plugin.feedback, objectives=campaign.objectives),
        definition=campaign.definition,
        budget=campaign.budget,
        lookahead=campaign.lookahead,
        seed_names=tuple(seed.name for seed in valid.seeds),
        tester=describe_plugin("tester", plugin.name, catalogues.testers.package(plugin.name)),
    )


def search_versions() -> dict[str, str]:
    """Returns the versions of the software that determines a search, by name."""
    packages = ("drivora", "numpy", "scipy", "libsumo")
    return {name: version(name) for name in packages}


def _tester(
    valid: ValidCampaign,
    catalogues: Catalogues,
    space: CandidateSpace,
    place: int,
    checkpoints: Checkpoints | None,
) -> Tester:
    """Returns the tester of the seed scenario at a place."""
    campaign, choice = valid.campaign, valid.campaign.tester
    context = TesterContext(
        space=space.genes,
        random=_generator(campaign.seed, _SEARCH, place),
        budget=math.ceil(campaign.budget / len(valid.seeds)),
        conflicts=space.conflicts,
        decode_alike=space.decode_alike,
        ego_distance=space.ego_distance,
        checkpoints=checkpoints,
        aims=aims_of(campaign.objectives),
    )
    components = make_components(mutation=choice.mutation, selection=choice.selection)
    tester = catalogues.testers.create(choice.name, context, choice.parameters, components)
    if choice.feedback is FeedbackMode.SHUFFLED:
        return ShuffledFeedback(tester, _generator(campaign.seed, _SHUFFLE, place))
    return tester


def _generator(seed: int, stream: int, place: int) -> np.random.Generator:
    # That of the first seed scenario is the same with and without others.
    key = (stream, place) if place else (stream,)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def _planned_motions(
    scenario: Scenario, network: RoadNetwork, until: float
) -> tuple[PlannedMotion, ...]:
    # Imported here: only few candidates are decoded outside workers, and it loads the simulation.
    from drivora_service.simulation.followers.free_motion import plan_motions

    return plan_motions(scenario, network, until)


def _refusal(pointer: str, code: str, named: str, error: Exception) -> InvalidDocument:
    return InvalidDocument((Problem(pointer=pointer, code=code, message=f"{named}{error}"),))
