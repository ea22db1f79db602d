"""Collisions of the ego, and the responsible party."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from drivora_service.observations.artefacts import Artefact, counterpart
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Actor
from drivora_service.oracles.avoidability.assess import assess
from drivora_service.oracles.responsibility import nuplan
from drivora_service.oracles.responsibility.finding import Fault, Finding
from drivora_service.oracles.responsibility.impact import Impact, find_impact
from drivora_service.oracles.responsibility.responsibility_judging import find_responsible
from drivora_service.oracles.verdict import Outcome, Verdict, not_started, passed, violated
from drivora_service.oracles.verdicts.artefact_verdicts import ARTEFACT
from drivora_service.oracles.verdicts.failure_facts import explain_collision


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FoundCollision:
    """A collision of an ego, and the responsible party.

    Attributes:
        k: The ego's row in which it begins.
    """

    k: int
    other: Actor
    impact: Impact
    finding: Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """Violated where the ego's box overlaps another actor's; the same actor counts once.

    The responsible party follows from a table of rules, judged by the evidence in the trace: see
    ``oracles/responsibility`` and the reference. Where no rule decides, it is undetermined. Not
    measurable where the first contact is an artefact of the simulator.

    Attributes:
        standing_speed: m/s up to which an actor stands (nuPlan).
        off_road: Metres outside the drivable area from which on the ego is off the road.
    """

    standing_speed: float = 0.05
    off_road: float = 0.3

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "collision"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every actor that an ego collided with."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        if ego.artefact is not None:
            return [self._spoilt(ego, ego.artefact)]
        verdicts = [self._verdict(ego, found) for found in self.find_collisions(ego)]
        return verdicts or [passed(self.name, ego, "No collision.")]

    def find_collisions(self, ego: EgoView) -> Iterator[FoundCollision]:
        """Yields the collisions of an ego that started, in the order of time, with their findings.

        Without the avoidability, which takes far longer.
        """
        trace = ego.trace
        met: set[int] = set()
        for contact in trace.contacts:
            row = counterpart(contact, ego.row)
            k = contact.step - ego.first
            if row is None or row in met or not 0 <= k < ego.count:
                continue
            met.add(row)
            other = trace.actors[row]
            impact = find_impact(trace, ego.actor, other, contact.step)
            finding = find_responsible(
                trace, ego.network, ego.actor, other, contact.step, impact, self.standing_speed
            )
            yield FoundCollision(k=k, other=other, impact=impact, finding=finding)

    def _spoilt(self, ego: EgoView, artefact: Artefact) -> Verdict:
        """Returns the verdict on an ego that the simulator had collide.

        It is no violation, so that no count, list or score has it.
        """
        trace, step, other = ego.trace, artefact.step, artefact.other
        time = float(trace.times[step])
        impact = find_impact(trace, ego.actor, other, step)
        return Verdict(
            oracle=self.name,
            ego=ego.id,
            outcome=Outcome.NOT_MEASURABLE,
            message=f"Artefact of the simulation at {time:.2f} s, not the ego's fault: "
            f"{artefact.in_words}. The ego has no scores in this run.",
            at_fault=False,
            counterpart=other.id,
            evidence={
                ARTEFACT: str(artefact.kind),
                "artefact_time": time,
                "artefact_step": step,
                "counterpart": other.id,
                "counterpart_role": str(other.role),
                "reason": artefact.in_words,
                "rule": "appeared",
                "face": str(impact.face),
                "other_face": str(impact.other_face),
                "nuplan_at_fault": False,
            },
        )

    def _verdict(self, ego: EgoView, collision: FoundCollision) -> Verdict:
        k, other = collision.k, collision.other
        impact, found = collision.impact, collision.finding
        own = None if found.since is None or found.fault is not Fault.EGO else found.since
        manoeuvre = None if own is None else own - ego.first
        replayed = assess(ego, k, other.row, manoeuvre=manoeuvre)
        chain = replayed.evidence.get("chain")
        return violated(
            self.name,
            ego,
            k,
            f"Collided with {other.id} at {impact.relative_speed:.1f} m/s: "
            f"{explain_collision(found.reason, chain)}.",
            at_fault=found.at_fault,
            undetermined=found.fault is Fault.UNKNOWN,
            avoidable=replayed.avoidable,
            physically_avoidable=replayed.physically_avoidable,
            avoidability=dict(replayed.evidence),
            counterpart=other.id,
            counterpart_role=str(other.role),
            reason=found.reason,
            rule=found.rule,
            face=str(impact.face),
            other_face=str(impact.other_face),
            ego_speed=impact.ego_speed,
            other_speed=impact.other_speed,
            relative_speed=impact.relative_speed,
            nuplan_at_fault=nuplan.at_fault(
                ego,
                k,
                impact,
                standing_speed=self.standing_speed,
                off_road=self.off_road,
            ),
        )
