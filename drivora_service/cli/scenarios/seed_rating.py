"""How often random scenarios of a scene fail: its seed run once, and a random campaign on it."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.oracles.verdicts.failure_definition import definition_of
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
from drivora_service.studies.failure_rates import FailureRate, describe_rate

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.api.schemas.runs import Run
    from drivora_service.client import Client

BATCH = "drivora seeds rate"
"""Name of the batch of the seeds' own runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedRun(Shape):
    """The run of a seed scenario as it is.

    Attributes:
        run_id: Its id; empty if it could not be run.
        status: Status of the run.
        failures: Oracles by which it fails.
        message: Why it has no result; empty otherwise.
    """

    run_id: str
    status: RunStatus
    failures: tuple[str, ...]
    message: str = ""

    def __str__(self) -> str:
        """Returns it in a few words."""
        if self.status is not RunStatus.FINISHED:
            return self.status.replace("_", " ")
        return f"fails: {', '.join(self.failures)}" if self.failures else "passes"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedRate(Shape):
    """How often the random scenarios of one scene fail.

    Attributes:
        name: Name of the seed scenario.
        town: Its road network.
        seed: The run of the seed scenario itself.
        total: By any oracle.
        oracles: By each oracle that failed any simulation; one may fail by several.
        without_result: Simulations that were not judged, such as those in which the ADS ended.
        words: What this means for a comparison of methods.
    """

    name: str
    town: str
    seed: SeedRun
    total: FailureRate
    oracles: Mapping[str, FailureRate]
    without_result: int
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneRates(Shape):
    """How often the random scenarios of scenes fail.

    Attributes:
        campaign_id: The campaign of random search that simulated them.
        batch_id: The batch of the seeds' own runs.
        definition: What counts as a failure, in words.
        scenes: By seed scenario.
        total: Of all together.
    """

    campaign_id: str
    batch_id: str
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


def run_seeds(
    client: Client, document: Mapping[str, Any], names: Sequence[str]
) -> tuple[str, tuple[SeedRun, ...]]:
    """Runs the seed scenarios of a campaign as they are.

    Args:
        client: Client of the application or service that runs them.
        document: The campaign, with defaults filled in.
        names: Display names of the seed scenarios.

    Returns:
        The id of their batch, and their runs in order.
    """
    seeds = seeds_of(document)
    agent = document.get("agent") or {}
    parameters = agent.get("parameters") or {}
    try:
        posted = client.post_batch(
            [json.dumps(one) for one in seeds.values()],
            labels=list(names),
            name=BATCH,
            agent=agent.get("name", ""),
            agent_parameters=[f"{key}={json.dumps(value)}" for key, value in parameters.items()],
            definition=definition_of(document),
        )
    except InvalidDocument as error:
        message = "; ".join(problem.message for problem in error.problems)
        refused = SeedRun(run_id="", status=RunStatus.INVALID, failures=(), message=message)
        return "", (refused,) * len(seeds)
    found: dict[int, SeedRun] = {}
    for item in posted.items:
        message = "; ".join(problem.message for problem in item.problems)
        found[item.item] = SeedRun(
            run_id="", status=RunStatus.INVALID, failures=(), message=message
        )
    for run in client.wait_for_batch(posted.batch.id):
        found[run.item] = _seed_run(run)
    return posted.batch.id, tuple(found[place] for place in range(len(seeds)))


def _seed_run(run: Run) -> SeedRun:
    failing = dict.fromkeys(run.verdicts[place].oracle for place in run.failing_verdicts)
    return SeedRun(
        run_id=run.id,
        status=run.status,
        failures=tuple(failing),
        message="" if run.error is None else run.error.message,
    )


def rate_scenes(
    client: Client,
    campaign: Campaign,
    names: Sequence[str],
    seeds: Sequence[SeedRun],
    batch_id: str,
) -> SceneRates:
    """Counts the failing simulations of a finished campaign of random search.

    Failures that an identical run did not repeat are left out.

    Args:
        client: Client of the application or service with the campaign.
        campaign: The campaign.
        names: Display names of its seed scenarios.
        seeds: Their own runs.
        batch_id: The batch of these.
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
    for place, (name, town, seed) in enumerate(zip(names, towns, seeds, strict=True)):
        numbers = simulated[place]
        total = FailureRate(
            failing=sum(number in failing for number in numbers), simulations=len(numbers)
        )
        oracles = sorted({oracle for number in numbers for oracle in failing.get(number, ())})
        scenes.append(
            SeedRate(
                name=name,
                town=town,
                seed=seed,
                total=total,
                oracles={
                    oracle: FailureRate(
                        failing=sum(oracle in failing.get(number, ()) for number in numbers),
                        simulations=len(numbers),
                    )
                    for oracle in oracles
                },
                without_result=unjudged[place],
                words=_words(seed, total),
            )
        )
    return SceneRates(
        campaign_id=campaign.id,
        batch_id=batch_id,
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


def _words(seed: SeedRun, total: FailureRate) -> str:
    words = describe_rate(total)
    if seed.failures:
        words += (
            f" The seed scenario itself fails ({', '.join(seed.failures)}): a search from it finds "
            "that failure again and again; mend the scenario, or take another."
        )
    elif seed.status is not RunStatus.FINISHED:
        words += f" The seed scenario itself has no result ({seed}: {seed.message})."
    return words
