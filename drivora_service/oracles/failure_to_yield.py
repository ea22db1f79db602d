"""The ego takes the right of way of another actor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.yielding.conflict import Conflict
from drivora_service.observations.yielding.vehicle_conflicts import (
    gives_way_to_vehicles,
    vehicle_conflicts,
)
from drivora_service.observations.yielding.walker_conflicts import (
    gives_way_to_walkers,
    walker_conflicts,
)
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_measurable,
    not_started,
    passed,
    violated,
)

_ONE_ACT = 10.0
"""Seconds within which what an ego does to the same other is one act."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureToYield:
    """Violated where the ego goes first although another has the right of way, and hinders it.

    At junctions that is a vehicle whose movement goes before the ego's by the network's own table,
    where neither the ego has a protected green nor the other a red signal, or one on green that
    crosses the way of an ego on red. On crossings it is a walker with the right of way by that
    table, or with a green signal. The other is hindered if the ego leaves a place less than the
    bound before the other is there, if they touch, or if a vehicle must brake hard because of the
    ego (``yielding.hindrance``). Which actor goes first where each yields to the other, as at an
    all-way stop, is not judged.

    Attributes:
        encroachment: Seconds between the ego's leaving a place and the other's being there.
        braking: m/s² from which on another brakes hard, on average over 0.5 s.
        attention: Seconds after the ego's passage within which others count.
    """

    encroachment: float = 1.0
    braking: float = 4.0
    attention: float = 4.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "failure_to_yield"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every actor whose right of way an ego took."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def find_conflicts(self, ego: EgoView) -> list[Conflict]:
        """Returns the conflicts in which an ego went before an actor with the right of way."""
        conflicts = [
            *vehicle_conflicts(ego, attention=self.attention),
            *walker_conflicts(ego, attention=self.attention),
        ]
        return sorted(conflicts, key=lambda one: (one.row, one.other))

    def hinders(self, conflict: Conflict) -> bool:
        """Returns whether the ego hindered the other in a conflict."""
        return conflict.lag < self.encroachment or conflict.braking >= self.braking

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if ego.count < 2:
            return [not_started(self.name, ego)]
        conflicts = self.find_conflicts(ego)
        verdicts = [self._make_violation(ego, conflict) for conflict in self._acts(ego, conflicts)]
        if verdicts:
            return verdicts
        nearest = min((conflict.lag for conflict in conflicts), default=None)
        facts = {
            "conflicts": len(conflicts),
            "least_encroachment": nearest if nearest is None or nearest < 1e3 else None,
        }
        if conflicts or gives_way_to_vehicles(ego) or gives_way_to_walkers(ego):
            return [passed(self.name, ego, "Hindered no actor with the right of way.", **facts)]
        if ego.crossings and not ego.network.path.is_file():
            message = "The file of the network, which has the right of way, is missing."
            return [not_measurable(self.name, ego, message)]
        message = "No junction or crossing on the way where others have the right of way."
        return [not_applicable(self.name, ego, message, **facts)]

    def _acts(self, ego: EgoView, conflicts: Sequence[Conflict]) -> list[Conflict]:
        """Returns the conflicts in which the ego hindered the other, one for each act.

        A junction may have several lines one after the other, and a ring has several junctions: the
        same other is hindered once.
        """
        acts: dict[int, Conflict] = {}
        found = []
        for conflict in conflicts:
            if not self.hinders(conflict):
                continue
            before = acts.get(conflict.other)
            acts[conflict.other] = conflict
            if before is None or (conflict.row - before.row) * ego.step_length > _ONE_ACT:
                found.append(conflict)
        return found

    def _make_violation(self, ego: EgoView, conflict: Conflict) -> Verdict:
        other_id = ego.trace.actors[conflict.other].id
        if conflict.lag < self.encroachment:
            how = f"reached the conflict point {conflict.lag:.1f} s after the ego had left it"
        else:
            how = f"had to brake at {conflict.braking:.1f} m/s²"
        return violated(
            self.name,
            ego,
            conflict.row,
            f"Went before {other_id}, which has the right of way and {how}.",
            at_fault=True,
            counterpart=other_id,
            place=conflict.place,
            encroachment=conflict.lag if conflict.lag < 1e3 else None,
            braking=conflict.braking,
            braked_at=float(ego.trace.times[conflict.braked]) if conflict.braked >= 0 else None,
        )
