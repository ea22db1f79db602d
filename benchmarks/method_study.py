"""The method study: repeated campaigns of every method against random testing.

Every method and its twin without feedback searches the same gene space on the same seed scenarios
with the same budget; a repetition differs in its seed alone. DoppelTest, which is about several
egos, has scenes of its own. Two study files run it:

    drivora study run benchmarks/studies/one-ego.yaml
    drivora study run benchmarks/studies/several-egos.yaml

The published results are from before there were study files. They are one line a campaign, and
these are the tables of them:

    python -m benchmarks.method_study show benchmarks/results/methods.jsonl.gz
"""

from __future__ import annotations

import argparse
import gzip
import itertools
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from drivora_service.campaigns.grouping import Grouping
from drivora_service.cli.campaign_files import shipped_campaigns
from drivora_service.oracles.failure_facts import relation
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.studies.comparison import compare_campaigns, measure
from drivora_service.studies.figures import CampaignFigures
from drivora_service.studies.situations import count_situations

AGENT = "idm"
STEP = 0.1
"""Seconds a step: half the steps of the default, for a study of 100,000 runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A seed scenario of about half a minute, and its space.

    Attributes:
        file: One of the shipped examples; its egos and weather are kept, other actors left out.
        egos: "one ego" or "several egos": which methods search it.
        space: What varies, as in a campaign file.
    """

    name: str
    file: str
    egos: str
    space: dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """A method on scenes of one kind.

    Attributes:
        target: The measure of what its authors want of it.
    """

    tester: str
    egos: str
    target: str
    feedback: str = "own"

    @property
    def name(self) -> str:
        """Its name in tables."""
        return self.tester if self.feedback == "own" else f"{self.tester} without feedback"


_MEETING = {"optional": True, "vehicles": 0, "walkers": 0, "weather": False}
SCENES = (
    Scene(
        name="motorway in rain",
        file="campaigns/highway-in-rain.json",
        egos="one ego",
        space={"vehicles": 4, "walkers": 0, "weather": False},
    ),
    Scene(
        name="wet arterial",
        file="wet-arterial.json",
        egos="one ego",
        space={"vehicles": 5, "walkers": 2, "weather": True},
    ),
    Scene(
        name="left turn",
        file="campaigns/market-street.json",
        egos="one ego",
        space={"vehicles": 6, "walkers": 1, "weather": True},
    ),
    Scene(
        name="left turn, five egos",
        file="campaigns/market-street.json",
        egos="several egos",
        space={**_MEETING, "egos": 5, "vehicles": 2, "max_ego_delay": 3.0},
    ),
    Scene(
        name="orchard lane, five egos",
        file="campaigns/orchard-lane.json",
        egos="several egos",
        space={**_MEETING, "egos": 5, "max_ego_delay": 3.0},
    ),
    Scene(
        name="church lane, eight egos",
        file="campaigns/church-lane.json",
        egos="several egos",
        space={**_MEETING, "egos": 8, "max_ego_delay": 4.0},
    ),
)
ARMS = (
    Arm(tester="random", egos="one ego", target="at_fault"),
    Arm(tester="avfuzzer", egos="one ego", target="at_fault"),
    Arm(tester="behavexplor", egos="one ego", target="situations"),
    Arm(tester="samota", egos="one ego", target="oracles"),
    Arm(tester="random", egos="several egos", target="kinds"),
    Arm(tester="doppeltest", egos="several egos", target="kinds"),
)
TWINS = tuple(replace(arm, feedback="shuffled") for arm in ARMS if arm.tester != "random")


def campaign_document(scene: Scene, arm: Arm, repetition: int, simulations: int) -> dict[str, Any]:
    """Writes the campaign of one repetition."""
    scenario = json.loads((shipped_campaigns().parent / scene.file).read_text())
    kept = {key: scenario[key] for key in ("version", "frame", "ego_vehicles", "map_region")}
    for ego in kept["ego_vehicles"]:
        ego["agent"] = {"name": AGENT}
    return {
        "name": campaign_name(scene, arm, repetition),
        "tester": {"name": arm.tester, "feedback": arm.feedback},
        "scenario": {**kept, "weather": scenario.get("weather", {}), "step_length": STEP},
        "space": scene.space,
        "budget": {"simulations": simulations},
        "seed": repetition,
    }


def campaign_name(scene: Scene, arm: Arm, repetition: int) -> str:
    """Returns the name of a campaign, which identifies it in the results."""
    return f"{scene.name}, {arm.name}, {repetition}"


_FORMER_NAMES = {"group": "method", "rules": "oracles", "clusters": "groups", "key": "kind"}
"""Names in results of earlier revisions, with the present ones."""

_RECORDED_LATER: dict[str, Any] = {
    **dict.fromkeys(("avoidable", "not_measurable", "unavoidable", "undetermined"), 0),
    **dict.fromkeys(("not_judged", "not_at_fault", "avoidable_kinds", "avoidable_situations"), 0),
    "first_avoidable": None,
    "found_avoidable": (),
}
"""Figures that these results lack, with what stands for them; they cannot be compared by them."""


_NOT_RECORDED = {*_RECORDED_LATER, "first_avoidable_s", "unchanged_share"}
"""Measures that need what these results lack."""


def read(path: Path) -> Iterator[dict[str, Any]]:
    """Reads the lines of results, with former names replaced by the present ones."""
    with gzip.open(path, "rt") as file:
        for text in file:
            line = json.loads(text)
            line["figures"] = _renamed(line["figures"])
            line["failures"] = [_renamed(found) for found in line["failures"]]
            yield line


def _renamed(values: Mapping[str, Any]) -> dict[str, Any]:
    return {_FORMER_NAMES.get(name, name): value for name, value in values.items()}


def figures_of_line(line: dict[str, Any]) -> CampaignFigures:
    """Returns the figures of a campaign: a function of its own failures alone."""
    # Not by kind, which a part of these results lacks: its place is told by its coordinates, too.
    failures = [
        (f"{verdict.oracle}|{relation(verdict.evidence)}", verdict)
        for verdict in map(_verdict, line["failures"])
    ]
    return CampaignFigures(
        **{
            **_RECORDED_LATER,
            **line["figures"],
            "found": tuple(line["figures"]["found"]),
            "groups": Grouping().count([verdict for _, verdict in failures]),
            "situations": count_situations(failures),
        }
    )


def _verdict(found: dict[str, Any]) -> Verdict:
    return Verdict(
        oracle=found["oracle"],
        ego="",
        outcome=Outcome.VIOLATED,
        message="",
        at_fault=found["at_fault"],
        time=found["time"],
        location=None if found["location"] is None else tuple(found["location"]),
        evidence=found["evidence"],
    )


def at_equal_time(lines: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leaves out the evaluations of campaigns after the duration of the shortest one.

    Seconds are those of one worker, the method's own included. Campaigns whose evaluations were
    not timed one by one are left out.
    """
    timed = [line for line in lines if "costs_s" in line]
    limit = min((sum(line["costs_s"]) for line in timed), default=0.0)
    return [_until(line, limit) for line in timed]


def _until(line: dict[str, Any], limit: float) -> dict[str, Any]:
    ends = itertools.accumulate(line["costs_s"])
    # Sums in another order may differ in the last digit.
    count = sum(end <= limit + 1e-6 for end in ends)
    failures = [found for found in line["failures"] if found["evaluation"] < count]
    figures = {
        **line["figures"],
        "simulations": count,
        "failing": len({found["evaluation"] for found in failures}),
        "at_fault": len({found["evaluation"] for found in failures if found["at_fault"]}),
        "kinds": len({found["kind"] for found in failures}),
        "oracles": len(
            {(found["oracle"], found["evidence"].get("counterpart_role")) for found in failures}
        ),
        "time_limit_s": limit,
    }
    return {**line, "figures": figures, "failures": failures}


def show(options: argparse.Namespace) -> None:
    """Prints the comparison as Markdown."""
    lines = list(read(options.results))
    for name in set(options.measure).intersection(_NOT_RECORDED):
        raise SystemExit(f"these results do not record {name!r}: leave the measure out")
    if options.ablation:
        print_heading("without")
        for twin in TWINS:
            pair = figures(lines, twin.egos, (twin.tester, twin.name), options.equal_time)
            print_rows(pair, twin.name, [twin.target])
        print()
        print_heading("random")
        for twin in TWINS:
            pair = figures(lines, twin.egos, (twin.name, "random"), options.equal_time)
            print_rows(pair, "random", [twin.target])
        return
    for egos in dict.fromkeys(scene.egos for scene in SCENES):
        arms = [arm.name for arm in ARMS if arm.egos == egos]
        print(f"\n### {egos}\n")
        print_heading("random")
        print_rows(figures(lines, egos, arms, options.equal_time), "random", options.measure)


def figures(
    lines: Sequence[dict[str, Any]], egos: str, methods: Collection[str], equal_time: bool
) -> list[CampaignFigures]:
    """Returns the figures of all campaigns of some methods, scene by scene."""
    found: list[CampaignFigures] = []
    for scene in SCENES:
        here = [
            line
            for line in lines
            if line["figures"]["scenario"] == scene.name and line["figures"]["method"] in methods
        ]
        if scene.egos == egos and here:
            found += map(figures_of_line, at_equal_time(here) if equal_time else here)
    return found


def print_heading(baseline: str) -> None:
    """Prints the head of a table."""
    print(f"| scene | measure | method | n | median | {baseline} | A12 (95 %) | p | p (Holm) |")
    print("|---|---|---|---|---|---|---|---|---|")


def print_rows(found: Sequence[CampaignFigures], baseline: str, measures: Sequence[str]) -> None:
    """Prints a row for each scene, measure and method but the baseline."""
    if len({one.method for one in found}) < 2:
        return
    for row in compare_campaigns(found, baseline, [measure(name) for name in measures]):
        a12 = f"{row.a12:.2f} ({row.low:.2f} to {row.high:.2f})"
        mark = " *" if row.is_better else ""
        print(
            f"| {row.scenario} | {row.title} | {row.method} | "
            f"{row.repetitions}/{row.baseline_repetitions} | {row.median:g} | "
            f"{row.baseline_median:g} | {a12} | {row.p:.2g} | {row.p_holm:.2g}{mark} |"
        )


def main() -> None:
    """Shows."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    showing = commands.add_parser("show")
    showing.add_argument("results", type=Path)
    showing.add_argument(
        "--measure",
        nargs="+",
        default=["at_fault", "situations", "kinds", "oracles", "first_failure"],
    )
    showing.add_argument(
        "--ablation",
        action="store_true",
        help="each method against itself without feedback, and that against random",
    )
    showing.add_argument("--equal-time", action="store_true", help="not at equal simulations")
    showing.set_defaults(do=show)
    options = parser.parse_args()
    options.do(options)


if __name__ == "__main__":
    main()
