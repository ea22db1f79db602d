"""Local search around each cluster of the candidates nearest to a violation."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.selection import best_first
from drivora_service.search.testers.samota.archive import Database
from drivora_service.search.testers.samota.breeding import Breeding, Region
from drivora_service.search.testers.samota.density import density_clusters
from drivora_service.search.testers.samota.encoding import Encoding
from drivora_service.search.testers.samota.surrogates import RadialBasis


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocalFind:
    """The most promising candidate of one cluster.

    Attributes:
        values: (d,) genes.
        members: Rows of the database in the cluster.
    """

    values: FloatArray
    members: IntArray


def clusters_of(features: FloatArray, least: int) -> tuple[IntArray, ...]:
    """Clusters candidates (n, e) by density; candidates in no cluster are left out.

    Args:
        features: Features of the candidates.
        least: Size of the smallest cluster.

    Returns:
        Rows of each cluster, in ascending order; one cluster of all if there are none.
    """
    if len(features) < 2 * least:
        return (np.arange(len(features)),)
    return density_clusters(features, least) or (np.arange(len(features)),)


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalSearch:
    """A genetic algorithm on one surrogate for each cluster.

    Attributes:
        top: Share of the database that is clustered.
        cluster: Least size of a cluster.
        generations: Number of generations.
        population: Number of candidates.
        breeding: The operators.
    """

    top: float
    cluster: int
    generations: int
    population: int
    breeding: Breeding

    def search(
        self,
        database: Database,
        objective: int,
        space: GeneSpace,
        encoding: Encoding,
        random: np.random.Generator,
    ) -> tuple[LocalFind, ...]:
        """Returns the most promising new candidate of each cluster for one objective (a column)."""
        scores = database.objectives[:, objective]
        count = max(math.ceil(self.top * len(database)), self.cluster)
        top = np.sort(np.argsort(scores, kind="stable")[:count])
        features, values = database.features[top], database.values[top]
        finds = []
        for rows in clusters_of(features, self.cluster):
            surrogate = RadialBasis.fit(features[rows], _scale_scores(scores[top[rows]]))
            region = Region(space=space, members=values[rows])
            found = self._evolve(surrogate, region, encoding, database, random)
            if found is not None:
                finds.append(LocalFind(values=found, members=top[rows]))
        return tuple(finds)

    def _evolve(
        self,
        surrogate: RadialBasis,
        region: Region,
        encoding: Encoding,
        database: Database,
        random: np.random.Generator,
    ) -> FloatArray | None:
        """Returns the best candidate that is not known; ``None`` if the region has no other."""
        values = region.sample(random, self.population)
        features = encoding.encode(values)
        scores = surrogate.predict(features)
        order = best_first(scores)
        values, features, scores = values[order], features[order], scores[order]
        for _ in range(self.generations):
            children = self.breeding.children(values, region, random)
            encoded = encoding.encode(children)
            scores = np.concatenate((scores, surrogate.predict(encoded)))
            kept = best_first(scores)[: self.population]
            values = np.concatenate((values, children))[kept]
            features = np.concatenate((features, encoded))[kept]
            scores = scores[kept]
        for row, known in enumerate(features):
            if not database.knows(known):
                return np.array(values[row])
        return None


def _scale_scores(scores: FloatArray) -> FloatArray:
    """Returns scores (n,) as one objective (n, 1) of mean 0 and deviation 1."""
    deviation = float(scores.std())
    centred = scores - scores.mean()
    scaled: FloatArray = centred / deviation if deviation > 1e-12 else centred
    return scaled[:, None]
