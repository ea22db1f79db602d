"""How often random scenarios of a scene fail: its seed run once, and a random campaign on it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.errors import ConfigurationError
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
from drivora_service.store.campaigns.seed_run_records import SeedRun
from drivora_service.studies.failure_rates import FailureRate, describe_rate

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.client import Client


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedRate(Shape):
    """How often the random scenarios of one scene fail.

    Attributes:
        name: Name of the seed scenario.
        town: Its road network.
        seed: The run of the seed scenario itself; null if the campaign did not run it, as of the
            later ones of many.
        total: By any oracle.
        oracles: By each oracle that failed any simulation; one may fail by several.
        without_result: Simulations that were not judged, such as those in which the ADS ended.
        words: What this means for a comparison of methods.
    """

    name: str
    town: str
    seed: SeedRun | None
    total: FailureRate
    oracles: Mapping[str, FailureRate]
    without_result: int
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneRates(Shape):
    """How often the random scenarios of scenes fail.

    Attributes:
        campaign_id: The campaign of random search that simulated them.
        definition: What counts as a failure, in words.
        scenes: By seed scenario.
        total: Of all together.
    """

    campaign_id: str
    definition: str
    scenes: tuple[SeedRate, ...]
    total: FailureRate


def scene_of_files(files: Sequence[Path], agent: str, preset: str) -> dict[str, Any]:
    """Returns a campaign on the scenarios of files, without its tester and budget.

    Args:
        files: Files and folders.
        agent: Drives every ego; "": as documented.
        preset: Name of the space.

    Raises:
        ConfigurationError: A path cannot be used.
        InvalidDocument: A file holds no scenario.
    """
    from drivora_service.cli.scenarios.scenario_files import read_files

    scenarios, unreadable = read_files(files, agent=agent)
    if unreadable:
        problems = [
            f"{one.path}: {problem.pointer or '/'}: {problem.message}"
            for one in unreadable
            for problem in one.problems
        ]
        raise ConfigurationError("\n".join(problems))
    return {
        "scenarios": [
            {
                "name": one.name,
                "scenario": one.document.model_dump(
                    mode="json", exclude_defaults=True, exclude_none=True
                ),
            }
            for one in scenarios
        ],
        "space": {"preset": preset},
    }


def random_campaign(
    scene: Mapping[str, Any], *, simulations: int, name: str, **changes: Any
) -> dict[str, Any]:
    """Returns a campaign of random search on a scene.

    Args:
        scene: A campaign, perhaps of another tester.
        simulations: Number of simulations for each of its seed scenarios.
        name: Display name.
        changes: Parts of the campaign that are replaced.
    """
    # Random search minimises nothing.
    kept = {k: v for k, v in scene.items() if k != "feedback"}
    several = scene.get("scenarios")
    count = len(several) if isinstance(several, list) else 1
    budget = {"simulations": simulations * max(count, 1)}
    return {**kept, "name": name, "tester": {"name": "random"}, "budget": budget, **changes}


def seeds_of(document: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Returns the seed scenarios of a valid campaign by their names."""
    if document.get("scenario") is not None:
        return {"": document["scenario"]}
    return {one["name"]: one["scenario"] for one in document["scenarios"]}


def rate_scenes(client: Client, campaign: Campaign, names: Sequence[str]) -> SceneRates:
    """Counts the failing simulations of a finished campaign of random search.

    Failures that an identical run did not repeat are left out.

    Args:
        client: Client of the application or service with the campaign.
        campaign: The campaign.
        names: Display names of its seed scenarios.
    """
    failing: dict[int, set[str]] = defaultdict(set)
    for failure in client.failures(campaign.id):
        if failure.confirmation is not Confirmation.FLAKY:
            failing[failure.evaluation].add(failure.verdict.oracle)
    simulated: dict[int, list[int]] = defaultdict(list)
    unjudged: dict[int, int] = defaultdict(int)
    for one in client.evaluations(campaign.id):
        if one.status != "invalid":
            simulated[one.seed_number].append(one.number)
            unjudged[one.seed_number] += one.status == "failed"
    towns = [str(seed["map_region"]["town"]) for seed in seeds_of(campaign.document).values()]
    scenes = []
    seeds = {one.place: one for one in campaign.seed_runs}
    for place, (name, town) in enumerate(zip(names, towns, strict=True)):
        numbers = simulated[place]
        total = FailureRate(
            failing=sum(number in failing for number in numbers), simulations=len(numbers)
        )
        oracles = sorted({oracle for number in numbers for oracle in failing.get(number, ())})
        scenes.append(
            SeedRate(
                name=name,
                town=town,
                seed=seeds.get(place),
                total=total,
                oracles={
                    oracle: FailureRate(
                        failing=sum(oracle in failing.get(number, ()) for number in numbers),
                        simulations=len(numbers),
                    )
                    for oracle in oracles
                },
                without_result=unjudged[place],
                words=_words(seeds.get(place), total),
            )
        )
    return SceneRates(
        campaign_id=campaign.id,
        definition=campaign.definition.words,
        scenes=tuple(scenes),
        total=FailureRate(
            failing=sum(one.total.failing for one in scenes),
            simulations=sum(one.total.simulations for one in scenes),
        ),
    )


def is_rated(campaign: Campaign) -> bool:
    """Returns whether a campaign has all simulations that it was to make."""
    return campaign.state is CampaignState.FINISHED


def seed_words(seed: SeedRun | None) -> str:
    """Returns how the run of a seed scenario ended, in a few words."""
    if seed is None:
        return "not run"
    if seed.status is not RunStatus.FINISHED:
        return seed.status.replace("_", " ")
    oracles = dict.fromkeys(verdict.oracle for verdict in seed.failures)
    return f"fails: {', '.join(oracles)}" if oracles else "passes"


def _words(seed: SeedRun | None, total: FailureRate) -> str:
    words = describe_rate(total)
    if seed is not None and seed_words(seed) != "passes":
        words += f" The seed scenario itself: {seed_words(seed)}."
    return words
