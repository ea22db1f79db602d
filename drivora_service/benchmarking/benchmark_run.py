"""A run of the benchmark of agents, as its card looks at it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.artefact_verdicts import find_artefact_verdicts
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.runs.run_records import RunRecord

COLLISION = "collision"
RED_LIGHT = "red_light"
DESTINATION = "destination"

_SPOILT = "simulation_artefact"
"""Cause of a run that ended by an artefact of the simulator."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchmarkRun:
    """A run of the benchmark that has ended.

    Attributes:
        network: Network of the run.
        number: Number of its scenario among those of the network, from 1.
    """

    network: str
    number: int
    record: RunRecord

    @property
    def name(self) -> str:
        """Name of its scenario."""
        return f"{self.network}-{self.number:02d}"

    @property
    def is_judged(self) -> bool:
        """Whether it says something of the agent: it finished, and was not spoilt by SUMO."""
        return self.record.status is RunStatus.FINISHED and not self.artefacts

    @property
    def artefacts(self) -> tuple[Verdict, ...]:
        """The verdicts that say that an artefact of the simulator ended it."""
        return find_artefact_verdicts(self.record.verdicts)

    @property
    def cause(self) -> str:
        """Short name of the reason that it was not judged."""
        return _SPOILT if self.artefacts else self.record.cause

    @property
    def reason(self) -> str:
        """The reason that it was not judged, in words."""
        if self.artefacts:
            return self.artefacts[0].message
        return "" if self.record.error is None else self.record.error.message

    @property
    def arrived(self) -> bool:
        """Whether the ego reached its destination in time."""
        return any(
            v.oracle == DESTINATION and v.outcome is Outcome.PASSED for v in self.record.verdicts
        )

    @property
    def violations(self) -> tuple[Verdict, ...]:
        """The violations."""
        return tuple(v for v in self.record.verdicts if v.outcome is Outcome.VIOLATED)

    @property
    def agent_cost_us(self) -> float | None:
        """Wall microseconds of the agent in a step; ``None`` if no agent drove."""
        costs = self.record.agent_cost_us.values()
        return math.fsum(costs) if costs else None

    def metric(self, name: str) -> float | None:
        """Returns a metric; ``None`` if it was not measurable."""
        value = self.record.metrics.get(name)
        return value if value is not None and math.isfinite(value) else None

    def has_violated(self, oracle: str, *, at_fault: bool = False) -> bool:
        """Returns whether the ego violated an oracle; with ``at_fault``, whether at its fault."""
        return any(v.oracle == oracle and (not at_fault or v.at_fault) for v in self.violations)

    def has_collided(self, degree: Accountability) -> bool:
        """Returns whether there was a collision with this accountability of the ego."""
        return any(v.oracle == COLLISION and accountability(v) is degree for v in self.violations)
