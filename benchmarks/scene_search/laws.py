"""Scenes at which a search for violations of traffic laws can tell something.

Where random draws show every way to violate the laws that the scene has, or none, a method that
searches for them finds no more. Wanted are scenes in which draws show several ways, some of them in
few draws only: there are likely to be others, which no draw has shown yet.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.scene_search.counting import run_candidates
from benchmarks.search_scenes import Scene, prepare_scene
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.run_report import RunStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownWays:
    """In how many draws of a scene each way to violate a law was shown.

    Attributes:
        scene: Its name.
        agent: The ADS.
        judged: Draws that were judged.
        ways: Draws by way: the law, a colon, and its sub-violation.
    """

    scene: str
    agent: str
    judged: int
    ways: Mapping[str, int]

    def expected_ways(self, draws: int) -> float:
        """Returns how many ways some of the draws are expected to show, by their shares."""
        return sum(1.0 - (1.0 - n / self.judged) ** draws for n in self.ways.values())

    @property
    def rare(self) -> int:
        """Number of ways that at most two draws have shown."""
        return sum(n <= 2 for n in self.ways.values())


def count_ways(evaluator: Evaluator, scene: Scene, draws: int, seed: int) -> ShownWays:
    """Draws scenarios anew, as random search does, and counts how laws are violated.

    Args:
        evaluator: Runs the candidates; it has no other user meanwhile.
        scene: The scene.
        draws: Number of draws; those that are no valid scenario, or not judged, do not count.
        seed: Seed of the draws.

    Raises:
        DrivoraError: The scene has no such space.
    """
    search = prepare_scene(scene)
    (part,) = search.parts
    values = part.candidates.genes.sample(np.random.default_rng(seed), draws)
    judged, ways = 0, Counter[str]()
    for report in run_candidates(evaluator, part, list(values)):
        if report.status is RunStatus.FINISHED:
            judged += 1
            ways.update(_find_ways(report.verdicts))
    return ShownWays(scene=scene.name, agent=scene.driver, judged=judged, ways=dict(ways))


def read(path: Path) -> list[ShownWays]:
    """Reads what was counted; nothing if there is no such file."""
    lines = path.read_text().splitlines() if path.is_file() else ()
    return [ShownWays(**json.loads(line)) for line in lines]


def rank_scenes(counted: Sequence[ShownWays]) -> list[ShownWays]:
    """Returns the scenes with most rare ways first; of equal ones, those with more ways."""
    return sorted(counted, key=lambda one: (-one.rare, -len(one.ways), one.scene))


def choose_scenes(counted: Sequence[ShownWays], number: int) -> list[ShownWays]:
    """Returns the first of the ranked scenes, at most one of a road network."""
    found: dict[str, ShownWays] = {}
    for one in rank_scenes(counted):
        if one.rare:
            found.setdefault(one.scene.split()[0], one)
    return list(found.values())[:number]


def show(counted: Sequence[ShownWays], draws: int) -> None:
    """Prints the scenes as a table in Markdown, ranked."""
    print("| scene | ADS | draws | ways shown | by at most two draws | expected in a campaign |")
    print("|---|---|---|---|---|---|")
    for one in rank_scenes(counted):
        if one.ways:
            print(
                f"| {one.scene} | `{one.agent}` | {one.judged} | {len(one.ways)} | {one.rare} "
                f"| {one.expected_ways(draws):.1f} of {draws} |"
            )


def _find_ways(verdicts: Sequence[Verdict]) -> set[str]:
    return {
        f"{verdict.oracle}: {way}"
        for verdict in verdicts
        if "ways" in verdict.evidence
        for way in verdict.evidence.get("sub_violations", ())
    }
