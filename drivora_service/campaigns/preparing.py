"""From a validated campaign to a search that is ready to run."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np

from drivora_service.campaigns.campaign import FeedbackMode
from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.engine import Search
from drivora_service.campaigns.failure_kinds import FailureKinds
from drivora_service.campaigns.reading import ValidCampaign
from drivora_service.campaigns.scenario_candidates import ScenarioCandidates
from drivora_service.campaigns.shuffling import ShuffledFeedback
from drivora_service.errors import InvalidDocument, NetworkError, Problem, SearchError
from drivora_service.search.catalogue import components_named
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.tester import Tester, TesterContext

_SEARCH, _SHUFFLE = 0, 1
"""Streams of random numbers that derive from a campaign's seed."""


def prepare_search(valid: ValidCampaign, catalogues: Catalogues, *, run_prefix: str) -> Search:
    """Builds the search of a campaign: its gene space and its tester.

    The same campaign always gives the same search.

    Args:
        valid: The campaign.
        catalogues: Catalogues for its names.
        run_prefix: Prefix of the ids of the runs.

    Raises:
        InvalidDocument: The gene space cannot be built, or the tester cannot search it.
    """
    campaign = valid.campaign
    try:
        space = ScenarioSpace(valid.seed, valid.network, campaign.space)
    except (SearchError, NetworkError) as error:
        raise _refusal("/space", "space", error) from error
    try:
        tester = _tester(valid, catalogues, space)
    except SearchError as error:
        raise _refusal("/tester", "tester", error) from error
    return Search(
        run_prefix=run_prefix,
        tester=tester,
        candidates=ScenarioCandidates(
            space=space,
            networks=catalogues.networks,
            agents=frozenset(catalogues.agents.names()),
        ),
        feedback=catalogues.testers.plugin(campaign.tester.name).feedback,
        oracles=frozenset(campaign.oracles),
        budget=campaign.budget,
        lookahead=campaign.lookahead,
        kind_of=FailureKinds(valid.network),
    )


def search_versions() -> dict[str, str]:
    """Returns the versions of the software that determines a search, by name."""
    packages = ("drivora", "numpy", "scipy", "scikit-learn", "pymoo", "libsumo")
    return {name: version(name) for name in packages}


def _tester(valid: ValidCampaign, catalogues: Catalogues, space: ScenarioSpace) -> Tester:
    campaign, choice = valid.campaign, valid.campaign.tester
    context = TesterContext(
        space=space.genes,
        random=_generator(campaign.seed, _SEARCH),
        budget=campaign.budget,
        conflicts=space.conflicts,
    )
    components = components_named(mutation=choice.mutation, selection=choice.selection)
    tester = catalogues.testers.create(choice.name, context, choice.parameters, components)
    if choice.feedback is FeedbackMode.SHUFFLED:
        return ShuffledFeedback(tester, _generator(campaign.seed, _SHUFFLE))
    return tester


def _generator(seed: int, stream: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(stream,)))


def _refusal(pointer: str, code: str, error: Exception) -> InvalidDocument:
    return InvalidDocument((Problem(pointer=pointer, code=code, message=str(error)),))
