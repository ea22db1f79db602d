"""Checks of the candidates that a search starts from."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.plain_data import MAX_LOOKED_AT, MAX_PROBLEMS
from drivora_service.search.genes import GeneSpace

_MOST_NAMED = 10
"""Number of names that a message lists."""


def check_start(document: CampaignDocument, network_sha256: str) -> Iterator[Problem]:
    """Checks the seed scenarios and the networks of the candidates that a search starts from."""
    start = document.tester.start_from
    if start is None:
        return
    pointer = "/tester/start_from"
    if start.network_sha256 not in (None, network_sha256):
        yield Problem(
            pointer=f"{pointer}/network_sha256",
            code="other_network",
            message="found the hash of another version of the road network: its genes mean other "
            "places. Import the version that the earlier campaign had, or start without it",
        )
    known = list(document.seeds)
    for place, one in enumerate(start.candidates[:MAX_LOOKED_AT]):
        if one.seed not in known:
            yield Problem(
                pointer=f"{pointer}/candidates/{place}/seed",
                code="unknown_seed",
                message=f"found {one.seed!r}; the seed scenarios of this campaign are: "
                + ", ".join(repr(name) for name in known[:_MOST_NAMED]),
            )


def start_notes(document: CampaignDocument) -> Iterator[str]:
    """Yields how known candidates are used, where a user may expect something else."""
    start = document.tester.start_from
    if start is None:
        return
    yield f"the search starts from {start.words}"
    budget = document.budget.simulations
    if len(start.candidates) >= budget:
        yield (
            f"the {len(start.candidates)} candidates to start from take the whole budget of "
            f"{budget} simulations: the method has none left to search with"
        )


def read_starts(document: CampaignDocument, seed: str, space: GeneSpace) -> list[FloatArray]:
    """Returns the genes (d,) of the candidates from which the search of a seed scenario starts.

    Raises:
        InvalidDocument: They are not of this space.
    """
    start = document.tester.start_from
    if start is None:
        return []
    problems: list[Problem] = []
    values: list[FloatArray] = []
    for place, one in enumerate(start.candidates):
        if one.seed != seed:
            continue
        genes = np.array(one.values, dtype=np.float64)
        values.append(genes)
        if len(genes) != len(space):
            message = f"found {len(genes)} genes; the space of this campaign has {len(space)}"
        elif not space.within(genes):
            odd = int(np.flatnonzero(space.clip(genes) != genes)[0])
            gene = space.genes[odd]
            message = (
                f"found {genes[odd]:g} for gene {space.names[odd]!r}; allowed: {gene.low:g} to "
                f"{gene.high:g}{', whole' if space.is_whole[odd] else ''}"
            )
        else:
            continue
        problems.append(
            Problem(
                pointer=f"/tester/start_from/candidates/{place}/values",
                code="other_space",
                message=f"{message}. Start from candidates of the same seed scenario and space",
            )
        )
    if problems:
        raise InvalidDocument(tuple(problems[:MAX_PROBLEMS]))
    return values
