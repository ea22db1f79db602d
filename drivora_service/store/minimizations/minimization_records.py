"""Values of minimisations that the store reads and writes, apart from its rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

from drivora_service.oracles.verdicts.failure_identity import FailureIdentity
from drivora_service.shapes import Shape


class MinimizationState(StrEnum):
    """The state of a minimisation."""

    QUEUED = "queued"
    RUNNING = "running"
    FINISHED = "finished"
    """A smaller scenario was found, or there is none; `one_minimal` tells whether it is minimal."""
    FAILED = "failed"
    """The failure could not be followed; `message` tells why."""
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"
    """The command that ran it has ended; the same request continues it."""

    @property
    def is_active(self) -> bool:
        """Whether it runs, or waits for its process."""
        return self in (MinimizationState.QUEUED, MinimizationState.RUNNING)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioSize(Shape):
    """The size of a scenario.

    Attributes:
        actors: Number of egos, NPC vehicles, walkers, obstacles and vehicles of the background
            traffic.
        background: Vehicles of the background traffic.
        patches: Slippery patches of the road.
        waypoints: Waypoints of all actors.
        settings: Values of weather, lights, region, extensions, seed and end that differ from
            their defaults.
        route_m: Length of the routes of the egos on the road, metres.
        sim_time_s: Simulated seconds of its run.
        digits: Digits of all its numbers.
    """

    actors: int
    egos: int
    vehicles: int
    walkers: int
    obstacles: int
    background: int
    waypoints: int
    settings: int
    route_m: float
    sim_time_s: float
    digits: int
    patches: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimizationProgress(Shape):
    """How far a minimisation is.

    Attributes:
        stage: What is being reduced, in one or two words.
        decided: Simulations that the search needed so far, which the budget limits. They are the
            same on any number of workers.
        simulations: Simulations so far, including those that workers made ahead of the search
            and that it did not need.
        simulation_s: Seconds that they took in the workers.
        before: The scenario as it was; null until its failure was reproduced.
        after: The smallest scenario so far.
        one_minimal: Whether every single reduction of the smallest scenario was tried and none
            fails in the same way; null before the end.
        reproduction_run_id: Recorded run of the scenario as it was; empty before its end.
        minimal_run_id: Recorded run of the smallest scenario; empty before its end.
        removed: What the smallest scenario lacks, one sentence each.
        document: The smallest scenario so far.
    """

    stage: str = ""
    decided: int = 0
    simulations: int = 0
    simulation_s: float = 0.0
    before: ScenarioSize | None = None
    after: ScenarioSize | None = None
    one_minimal: bool | None = None
    reproduction_run_id: str = ""
    minimal_run_id: str = ""
    removed: tuple[str, ...] = ()
    document: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NewMinimization:
    """A minimisation to be stored.

    Attributes:
        run_id: Run that fails.
        failure: What its proposals must have in common with it.
        budget: Simulations that the search may need.
        document: The scenario that the run drove, as JSON.
        owner_id: Process of a command that will run it; "": any service.
    """

    run_id: str
    failure: FailureIdentity
    budget: int
    document: str
    owner_id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimizationSummary(Shape):
    """A minimisation in a list.

    Attributes:
        run_id: Run that fails.
        message: Why it failed; empty otherwise.
        failure: What proposals must have in common with the run.
        budget: Simulations that the search may need.
        batch_id: Batch of its runs.
        stage: What is being reduced, in one or two words.
        decided: Simulations that the search needed so far, which the budget limits. They are the
            same on any number of workers.
        simulations: Simulations so far, including those that workers made ahead of the search
            and that it did not need.
        simulation_s: Seconds that they took in the workers.
        before: The scenario as it was; null until its failure was reproduced.
        after: The smallest scenario so far.
        one_minimal: Whether every single reduction of the smallest scenario was tried and none
            fails in the same way; null before the end.
        reproduction_run_id: Recorded run of the scenario as it was; empty before its end.
        minimal_run_id: Recorded run of the smallest scenario; empty before its end.
        revision: Count of all changes at its newest one; see `GET /events`.
    """

    id: str
    run_id: str
    state: MinimizationState
    message: str
    failure: FailureIdentity
    budget: int
    batch_id: str
    stage: str
    decided: int
    simulations: int
    simulation_s: float
    before: ScenarioSize | None
    after: ScenarioSize | None
    one_minimal: bool | None
    reproduction_run_id: str
    minimal_run_id: str
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimizationRecord(MinimizationSummary):
    """A minimisation with its result.

    Attributes:
        removed: What the smallest scenario lacks, one sentence each.
        document: The smallest scenario so far; null until its failure was reproduced.
    """

    removed: tuple[str, ...] = ()
    document: Mapping[str, Any] | None = None
