"""Searches scenes on which a study of methods can tell something.

Where random search fails in every seventh run there is nothing to search, and where it fails in one
of three hundred nothing to measure. Wanted are scenes in which 0.5 to 2 % of random draws are
avoidable failures at the ego's fault. Scenes are sifted: all with few draws, those that may be in
the range with more, and those that are with 2,000, for which the exact interval is given.

    python -m benchmarks.scene_search --out FOLDER
    python -m benchmarks.scene_search --out FOLDER --detours
    python -m benchmarks.scene_search --out FOLDER --laws
    python -m benchmarks.scene_search --out FOLDER --show
    python -m benchmarks.scene_search --out FOLDER --write SCENES

With `--detours`, also of the last two, scenes for Decictor are searched: what counts is the oracle
`non_optimal_decision`. With `--laws`, in the same way, those for LawBreaker: how many ways to
violate traffic laws draws show, and in how many draws each. The last command writes the seed
scenarios of the scenes in the range, for a study file, and prints their spaces.

What was counted is kept in the folder, and not counted again.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.scene_search.counting import Counts, count
from benchmarks.scene_search.laws import choose_scenes, count_ways
from benchmarks.scene_search.laws import read as read_laws
from benchmarks.scene_search.laws import show as show_laws
from benchmarks.scene_search.scenes import detour_scenes, failing_scenes, law_scenes
from benchmarks.search_scenes import Scene
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.errors import DrivoraError
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.worker.setup import WorkerSetup

WANTED = (0.005, 0.02)
"""Share of avoidable failures at the ego's fault."""
STAGES = (100, 400, 2000)
"""Draws of each stage, each with a seed of its own."""
LAW_SCENES = 3
"""Scenes of a study of laws."""
LAW_DRAWS = 200
"""Draws in which ways to violate laws are counted."""
CAMPAIGN = 300
"""Simulations of a campaign, of which it is told how many ways they are expected to show."""


def may_be_wanted(found: Counts) -> bool:
    """Returns whether the interval of the share meets the wanted range, and something failed."""
    low, high = found.interval
    return found.avoidable > 0 and low <= WANTED[1] and high >= WANTED[0]


def is_wanted(found: Counts) -> bool:
    """Returns whether the share itself is in the wanted range."""
    return found.judged > 0 and WANTED[0] <= found.avoidable / found.judged <= WANTED[1]


class Ledger:
    """What was counted, one line a scene, ADS and stage."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "counts.jsonl"
        self._known: dict[tuple[str, str, int], Counts] = {}
        if self._path.is_file():
            for text in self._path.read_text().splitlines():
                line = json.loads(text)
                key = line.pop("scene"), line.pop("agent"), line.pop("draws")
                self._known[key] = Counts(**line)

    def get(self, scene: Scene, draws: int) -> Counts | None:
        """Returns what was counted before, ``None`` if it was not."""
        return self._known.get((scene.name, scene.driver, draws))

    def add(self, scene: Scene, draws: int, found: Counts) -> None:
        """Keeps a count."""
        self._known[scene.name, scene.driver, draws] = found
        line = {"scene": scene.name, "agent": scene.driver, "draws": draws, **asdict(found)}
        with self._path.open("a") as file:
            file.write(json.dumps(line) + "\n")


def show(scenes: Sequence[Scene], ledger: Ledger) -> None:
    """Prints the scenes of the last stage as a table in Markdown."""
    print("| scene | ADS | at fault | avoidable | 95 % interval | ms a run |")
    print("|---|---|---|---|---|---|")
    for scene in scenes:
        found = ledger.get(scene, STAGES[-1])
        if found is None:
            continue
        low, high = found.interval
        mark = " *" if is_wanted(found) else ""
        print(
            f"| {scene.name} | `{scene.driver}` | {found.at_fault} of {found.judged} "
            f"| {found.avoidable} ({found.avoidable / found.judged:.2%}){mark} "
            f"| {low:.2%} to {high:.2%} | {1000.0 * found.seconds:.0f} |"
        )


def in_the_range(scenes: Sequence[Scene], ledger: Ledger) -> list[Scene]:
    """Returns the scenes that are wanted by the counts of the last stage."""
    counts = ((scene, ledger.get(scene, STAGES[-1])) for scene in scenes)
    return [scene for scene, found in counts if found is not None and is_wanted(found)]


def of_laws(path: Path) -> list[Scene]:
    """Returns the scenes that tell most about violations of laws."""
    names = [one.scene for one in choose_scenes(read_laws(path), LAW_SCENES)]
    return [scene for scene in law_scenes() if scene.name in names]


def write(scenes: Sequence[Scene], folder: Path) -> None:
    """Writes seed scenarios; prints them as entries of a study."""
    folder.mkdir(parents=True, exist_ok=True)
    for scene in scenes:
        place = scene.name.partition(",")[0]
        # A path is that of an ADS.
        told = f"{place} {scene.agent}" if scene.oracles else place
        file = folder / (told.replace(" ", "-") + ".json")
        file.write_text(json.dumps(scene.scenario, indent=2) + "\n")
        print(f"  - file: {folder.name}/{file.name}  # {scene.driver}")
        print(f"    label: {json.dumps(scene.name)}")
        print(f"    space: {json.dumps(scene.space)}")


def main(arguments: Sequence[str]) -> None:
    """Counts what is not known yet, stage by stage, and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder of what was counted")
    parser.add_argument("--detours", action="store_true", help="needless detours, not failures")
    parser.add_argument("--laws", action="store_true", help="ways to violate laws")
    parser.add_argument("--show", action="store_true", help="only print the table")
    parser.add_argument("--write", type=Path, help="only write the scenes in the range")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    ledger = Ledger(options.out)
    scenes = list(detour_scenes() if options.detours else failing_scenes())
    ways = options.out / "laws.jsonl"
    if options.write is not None:
        write(of_laws(ways) if options.laws else in_the_range(scenes, ledger), options.write)
        return
    if not options.show:
        with (
            tempfile.TemporaryDirectory() as folder,
            LocalExecutor(
                slots=options.workers,
                setup=WorkerSetup(shipped_networks=shipped_networks()),
                folder=Path(folder),
            ) as executor,
        ):
            evaluator = LocalEvaluator(executor)
            if options.laws:
                _count_laws(list(law_scenes()), evaluator, ways)
            else:
                _sift(scenes, evaluator, ledger)
    if options.laws:
        show_laws(read_laws(ways), CAMPAIGN)
    else:
        show(scenes, ledger)


def _count_laws(scenes: Sequence[Scene], evaluator: LocalEvaluator, path: Path) -> None:
    known = {(one.scene, one.agent) for one in read_laws(path)}
    for scene in scenes:
        if (scene.name, scene.driver) in known:
            continue
        try:
            found = count_ways(evaluator, scene, LAW_DRAWS, seed=1000)
        except DrivoraError as error:
            # Such as a space whose walkers find no place around the route.
            print(f"{scene.name}, {scene.driver}: {error}", file=sys.stderr, flush=True)
            continue
        with path.open("a") as file:
            file.write(json.dumps(asdict(found)) + "\n")


def _sift(scenes: Sequence[Scene], evaluator: LocalEvaluator, ledger: Ledger) -> None:
    """Takes each scene through all stages but the last; then those that are left through it."""
    kept = []
    for scene in scenes:
        if all(_may_go_on(evaluator, ledger, scene, stage) for stage in range(len(STAGES) - 1)):
            kept.append(scene)
            print(f"may be wanted: {scene.name}, {scene.driver}", file=sys.stderr, flush=True)
    for scene in kept:
        _may_go_on(evaluator, ledger, scene, len(STAGES) - 1)


def _may_go_on(evaluator: LocalEvaluator, ledger: Ledger, scene: Scene, stage: int) -> bool:
    found = ledger.get(scene, STAGES[stage])
    if found is None:
        try:
            found = count(evaluator, scene, STAGES[stage], seed=1000 + stage)
        except DrivoraError as error:
            # Such as a space whose walkers find no place around the route.
            print(f"{scene.name}, {scene.driver}: {error}", file=sys.stderr, flush=True)
            found = Counts()
        ledger.add(scene, STAGES[stage], found)
    return may_be_wanted(found)


if __name__ == "__main__":
    main(sys.argv[1:])
