"""Density clusters of up to a few thousand points: HDBSCAN.

Source: Campello, Moulavi, Sander, "Density-based clustering based on hierarchical density
estimates" (2013). A cluster is a part of the points that stays together over a wide range of
densities. The clusters are those of scikit-learn's HDBSCAN, in the same order; the tests compare
them. scikit-learn takes a second to import, and its checks take longer than the clusters
(decision 18).
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray


def density_clusters(points: FloatArray, least: int) -> tuple[IntArray, ...]:
    """Clusters points; those in sparse places are in no cluster.

    Args:
        points: (n, e).
        least: Size of the smallest cluster, at most n; also the number of neighbours, the point
            itself included, within whose distance a point counts as dense.

    Returns:
        Rows of each cluster, in ascending order.
    """
    merges = _merges(*_spanning_tree(points, least))
    clusters = _condense_tree(merges, len(points), least)
    return tuple(
        np.array(sorted(_points(clusters, number)), dtype=np.int64)
        for number in _select_clusters(clusters)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Merge:
    """A union of two nodes: points (below n), or unions (n and above, in their order)."""

    left: int
    right: int
    distance: float
    size: int


@dataclass(slots=True, kw_only=True)
class _Cluster:
    """A cluster of the hierarchy.

    Attributes:
        birth: Density at which it splits off; densities are inverse distances.
        stability: Sum over its points of the range of densities at which they are in it.
        points: Points that leave it by themselves.
        parts: Numbers of the two clusters into which it splits, if it does.
    """

    birth: float
    stability: float = 0.0
    points: list[int] = field(default_factory=list)
    parts: tuple[int, ...] = ()


def _distances(points: FloatArray) -> FloatArray:
    # Differences, and not one product as in surrogates.squared_distances: equal points must have
    # the distance 0 exactly, at which their density is infinite.
    columns = np.ascontiguousarray(points.T)
    found = np.empty((len(points), len(points)))
    for row, squares in enumerate(found):
        apart = columns - columns[:, [row]]
        apart *= apart
        # Over the first axis, the terms are added in order, so that the sum is symmetric.
        apart.sum(axis=0, out=squares)
    return np.sqrt(found, out=found)


def _spanning_tree(points: FloatArray, least: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Returns the edges (n - 1,) of the minimum spanning tree, the shortest first.

    Distances are mutual reachabilities: at least the radius in which either point is dense. This
    is Prim's algorithm.
    """
    # The least-th neighbour, counting the point itself, whose distance is the smallest one.
    distances = _distances(points)
    radii = np.partition(distances, least - 1, axis=1)[:, least - 1]
    np.maximum(distances, radii, out=distances)
    np.maximum(distances, radii[:, None], out=distances)
    n = len(points)
    nearest = np.full(n, np.inf)
    sources = np.zeros(n, dtype=np.int64)
    is_outside = np.ones(n, dtype=np.bool_)
    ones, others = np.empty((2, n - 1), dtype=np.int64)
    lengths = np.empty(n - 1)
    # Prim and not Kruskal, which would sort the n² edges of a complete graph.
    node = 0
    for edge in range(n - 1):
        is_outside[node] = False
        nearest[node] = np.inf
        nearer = (distances[node] < nearest) & is_outside
        nearest[nearer] = distances[node, nearer]
        sources[nearer] = node
        node = int(nearest.argmin())
        ones[edge], others[edge], lengths[edge] = sources[node], node, nearest[node]
    order = np.argsort(lengths)
    return ones[order], others[order], lengths[order]


def _merges(ones: IntArray, others: IntArray, lengths: FloatArray) -> list[_Merge]:
    """Returns the unions along the edges, in order."""
    # A union-find forest: a union is the root of its two parts, and numbered after all before it,
    # so that the numbers ascend with the distance.
    n = len(lengths) + 1
    parents = list(range(2 * n - 1))
    sizes = [1] * n + [0] * (n - 1)
    merges = []
    for new, (one, other, distance) in enumerate(
        zip(ones.tolist(), others.tolist(), lengths.tolist(), strict=True), start=n
    ):
        left, right = _root(parents, one), _root(parents, other)
        parents[left] = parents[right] = new
        sizes[new] = sizes[left] + sizes[right]
        merges.append(_Merge(left=left, right=right, distance=distance, size=sizes[new]))
    return merges


def _root(parents: list[int], node: int) -> int:
    while parents[node] != node:
        # Path halving: later searches skip every other node.
        parents[node] = parents[parents[node]]
        node = parents[node]
    return node


def _condense_tree(merges: list[_Merge], n: int, least: int) -> list[_Cluster]:
    """Returns the hierarchy of clusters of at least the least size; the first is all points."""

    def size(node: int) -> int:
        return 1 if node < n else merges[node - n].size

    # From the union of all points down, which is from low densities to high ones. Only two parts
    # that are both large enough are new clusters; a smaller part leaves the cluster point by point,
    # and what remains is the same cluster at a higher density.
    clusters = [_Cluster(birth=0.0)]
    queue = deque([(2 * n - 2, 0)])
    while queue:
        node, number = queue.popleft()
        if node < n:
            continue
        merge, cluster = merges[node - n], clusters[number]
        density = 1.0 / merge.distance if merge.distance > 0.0 else np.inf
        parts = (merge.left, merge.right)
        if all(size(part) >= least for part in parts):
            cluster.parts = (len(clusters), len(clusters) + 1)
            for part in parts:
                cluster.stability += (density - cluster.birth) * size(part)
                queue.append((part, len(clusters)))
                clusters.append(_Cluster(birth=density))
            continue
        for part in parts:
            if size(part) >= least:
                queue.append((part, number))
                continue
            for point in _leaves(merges, n, part):
                cluster.stability += density - cluster.birth
                cluster.points.append(point)
    return clusters


def _leaves(merges: list[_Merge], n: int, node: int) -> list[int]:
    """Returns the points under a node."""
    points, open_ = [], [node]
    while open_:
        node = open_.pop()
        if node < n:
            points.append(node)
        else:
            open_ += (merges[node - n].left, merges[node - n].right)
    return points


def _select_clusters(clusters: list[_Cluster]) -> list[int]:
    """Returns the numbers of the most stable clusters of which none contains another.

    All points together are no cluster.
    """
    # From the smallest clusters up, as parts have greater numbers than what they are parts of:
    # either a cluster is chosen, or the best choice within it, whichever is more stable in sum. Of
    # equals, the larger cluster.
    stability = [cluster.stability for cluster in clusters]
    chosen: list[list[int]] = [[] for _ in clusters]
    for number in range(len(clusters) - 1, 0, -1):
        parts = clusters[number].parts
        within = sum(stability[part] for part in parts)
        if within > stability[number]:
            stability[number] = within
            chosen[number] = [one for part in parts for one in chosen[part]]
        else:
            chosen[number] = [number]
    return sorted(one for part in clusters[0].parts for one in chosen[part])


def _points(clusters: list[_Cluster], number: int) -> list[int]:
    """Returns the points of a cluster and of all clusters in it."""
    points: list[int] = []
    open_ = [number]
    while open_:
        cluster = clusters[open_.pop()]
        points += cluster.points
        open_ += cluster.parts
    return points
