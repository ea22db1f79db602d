"""A package's own oracle, metric and tester; one gene of a space decides what they measure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    Control,
    Observation,
)
from drivora_service.agents.plugin import agent_plugin
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.metrics.measured import Combine
from drivora_service.metrics.plugin import MetricPlugin
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col, Role
from drivora_service.oracles.oracle_descriptions import Better
from drivora_service.oracles.plugin import OracleObjective, OraclePlugin
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_started,
    passed,
    violated,
)
from drivora_service.search.aims import Guidance
from drivora_service.search.budget_bounds import within_budget
from drivora_service.search.components import Components
from drivora_service.search.mutation import GaussianMutation
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import Proposal, TesterContext
from drivora_service.search.testers.script import Script, ScriptedTester


def fastest_walker(ego: EgoView) -> float | None:
    """Returns the greatest speed of a walker in m/s; ``None`` without walkers."""
    rows = [actor.row for actor in ego.trace.actors if actor.role is Role.NPC_WALKER]
    if not rows:
        return None
    part = slice(ego.first, ego.first + ego.count)
    states = ego.trace.states[part, rows]
    speeds = np.hypot(states[:, :, Col.VX], states[:, :, Col.VY])
    return float(np.where(ego.trace.present[part, rows], speeds, 0.0).max())


@dataclass(frozen=True, slots=True, kw_only=True)
class WalkerRuns:
    """Violated where a walker is faster than the limit in m/s, almost that of the gene."""

    limit: float = 2.999

    @property
    def name(self) -> str:
        return "walker_runs"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> Iterator[Verdict]:
        if not ego.count:
            yield not_started(self.name, ego)
            return
        speed = fastest_walker(ego)
        if speed is None:
            yield not_applicable(self.name, ego, "No walker in the run.")
        elif speed > self.limit:
            yield violated(self.name, ego, 0, "It runs.", walker_spare=self.limit - speed)
        else:
            yield passed(self.name, ego, "It walks.", walker_spare=self.limit - speed)


ORACLE = OraclePlugin(
    name="walker_runs",
    description="no walker runs",
    create=WalkerRuns,
    objectives=(
        OracleObjective(
            name="walker_spare", description="How much faster a walker may be.", unit="m/s"
        ),
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class WalkerSpeed:
    def measure(self, ego: EgoView) -> float | None:
        return fastest_walker(ego)


METRIC = MetricPlugin(
    name="walker_speed_mps",
    description="The greatest speed of a walker.",
    create=WalkerSpeed,
    unit="m/s",
    better=Better.NEITHER,
    several_egos=Combine.MOST,
)


@dataclass(frozen=True, kw_only=True)
class ClimberParameters:
    children: Annotated[int, within_budget(1)] = 4


def climb(context: TesterContext, parameters: ClimberParameters, _: Components) -> Script:
    """Mutates the candidate with the least value of the one objective."""
    mutation, name = GaussianMutation(), context.objective("min_gap")
    best, least = context.space.sample(context.random), np.inf
    while True:
        told = yield tuple(
            Proposal(values=mutation.mutate(best, context.space, context.random), origin="mutation")
            for _ in range(parameters.children)
        )
        for one in told:
            value = None if one.measurement is None else one.measurement.objectives[name]
            if value is not None and value < least:
                best, least = one.proposal.values, value


TESTER = TesterPlugin(
    name="own-climber",
    title="Climber",
    description="mutates the best candidate",
    source="the tests",
    parameters=ClimberParameters,
    feedback=FeedbackChoice(name="general"),
    create=lambda *given: ScriptedTester(climb(*given)),
    is_generational=True,
    guidance=Guidance.ONE,
)


class Parker:
    """An ADS that does not move."""

    def setup_env(self, context: AgentContext) -> None:
        pass

    def run_step(self, observation: Observation) -> Control:
        return AccelerationControl(-2.0 if observation.speed > 0.0 else 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkerParameters:
    """It has none."""


AGENT = agent_plugin(
    AgentEntry(
        name="parker",
        kind=AgentKind.MODULE_BASED,
        description="does not move",
        source="the tests",
        licence="MIT",
    ),
    ParkerParameters,
    lambda _parameters: Parker(),
)
