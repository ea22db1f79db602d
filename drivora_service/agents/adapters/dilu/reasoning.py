"""DiLu's reasoning and reflection for one run: decisions, and learning from their results."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass, field

from drivora_service.agents.adapters.dilu.decisions import DECISIONS, Decision, decision_in
from drivora_service.agents.adapters.dilu.experiences import Experience, Memory, Recalled
from drivora_service.agents.adapters.dilu.models import ChatModel, ModelError
from drivora_service.agents.adapters.dilu.prompts import (
    Message,
    check_messages,
    decision_messages,
    question,
    reflection_messages,
)
from drivora_service.agents.adapters.dilu.situation import Situation, available
from drivora_service.agents.log import AgentLog

_GOOD_AFTER = 5
"""Following decisions without a mistake after which a decision counts as good."""

_WORTH_KEEPING = 5
"""Interval of the good decisions that may be kept, as in DiLu."""

_MOVING = 1.0
"""m/s; at standstill a decision does not count as good."""

_LOOK_BACK = 4
"""Number of last decisions that are searched for the cause of a mistake."""


@dataclass(slots=True, kw_only=True, eq=False)
class _Made:
    """A decision of this run."""

    situation: Situation
    decision: Decision
    answer: str


@dataclass(slots=True, kw_only=True)
class Counts:
    """The counts of the run so far.

    Attributes:
        decisions: Decisions made.
        unclear: Answers without a decision in them.
        unparsed: Answers still unclear after asking again: the decision was to keep.
        impossible: Decisions that were not available: the decision was to keep.
        like_nearest: Decisions equal to that of the nearest example.
        reflections: Requested reflections.
        corrected: Reflections that led to an experience.
        gained: Good decisions that were kept as experiences.
    """

    decisions: int = 0
    unclear: int = 0
    unparsed: int = 0
    impossible: int = 0
    like_nearest: int = 0
    reflections: int = 0
    corrected: int = 0
    gained: int = 0


@dataclass(slots=True, kw_only=True, eq=False)
class Driver:
    """The language model as the driver of one run.

    Attributes:
        model: The model.
        memory: The memory, which grows during the run.
        examples: Experiences to show with each question.
        log: Log of the agent.
    """

    model: ChatModel
    memory: Memory
    examples: int
    log: AgentLog
    counts: Counts = field(default_factory=Counts)
    _made: list[_Made] = field(default_factory=list)
    _trouble_at: int = -1

    def decide(self, situation: Situation, until: float) -> Decision:
        """Returns the model's decision.

        Args:
            situation: The present situation.
            until: Deadline of the answers on the monotonic clock.

        Raises:
            ModelError: It does not answer.
        """
        if situation.speed > _MOVING:
            self._keep_good_decision()
        recalled = self.memory.recall(situation, self.examples)
        # The nearest one last, since a model weighs its last input most; the others by number, so
        # that questions have the same beginning, which the model caches.
        shown = sorted(recalled[1:], key=lambda each: each.number) + recalled[:1]
        messages = decision_messages(
            [each.experience for each in shown], situation, reasons=self.model.reasons
        )
        self.log.event(f"situation: {messages[-1].content}")
        self.log.event(f"examples: {_format_recalled(recalled)}")
        allowed = available(situation)
        answer = self.model.answer(messages, allowed, self._left(until))
        self.log.event(f"answer: {_quote(answer)}")
        decision = decision_in(answer)
        if decision is None:
            decision = self._ask_again(answer, until)
        if decision not in allowed:
            self.counts.impossible += 1
            self.log.event(f"{decision} is not available: keep")
            decision = Decision.KEEP
        self.counts.decisions += 1
        self.counts.like_nearest += bool(recalled and recalled[0].experience.decision is decision)
        self._made.append(_Made(situation=situation, decision=decision, answer=answer))
        self.log.event(f"decision: {decision}")
        return decision

    def _ask_again(self, answer: str, until: float) -> Decision:
        self.counts.unclear += 1
        again = self.model.answer(check_messages(answer), DECISIONS, self._left(until))
        self.log.event(f"no decision in it; asked again: {_quote(again)}")
        decision = decision_in(again)
        if decision is None:
            self.counts.unparsed += 1
            self.log.event("no decision again: keep")
        return decision or Decision.KEEP

    def _left(self, until: float) -> float:
        left = until - time.monotonic()
        if left <= 0.0:
            raise ModelError(
                f"{self.model.name} was asked more than once in a step, and took the time for all "
                "of it for less: use a faster model, or give it more time"
            )
        return left

    def reflect(self, braking: float, until: float) -> None:
        """Requests a correction of the last decision other than to decelerate, after hard braking.

        Args:
            braking: Deceleration, m/s².
            until: Deadline of the answers on the monotonic clock.

        Raises:
            ModelError: The model does not answer.
        """
        self._trouble_at = len(self._made)
        made = next(
            (
                m
                for m in reversed(self._made[-_LOOK_BACK:])
                if m.decision is not Decision.DECELERATE
            ),
            None,
        )
        if made is None:
            return
        self.counts.reflections += 1
        self.log.event(
            f"reflection: braked by {braking:.1f} m/s² after {made.decision} in: "
            f"{question(made.situation, reasons=self.model.reasons).content}"
        )
        answer = self.model.answer(
            self._reflection(made), available(made.situation), self._left(until)
        )
        self.log.event(f"answer: {_quote(answer)}")
        corrected = decision_in(answer)
        if corrected is None or corrected is made.decision:
            self.log.event("no correction in it")
            return
        self.counts.corrected += 1
        why = "I made a mistake here before: " + " ".join(answer.rpartition("\n")[0].split())
        self._remember(made.situation, corrected, why)

    def _reflection(self, made: _Made) -> list[Message]:
        return reflection_messages(
            made.situation, made.decision, made.answer, reasons=self.model.reasons
        )

    def _keep_good_decision(self) -> None:
        """Keeps an earlier decision, if no mistake followed and it is new."""
        number = len(self._made) - _GOOD_AFTER
        if number < 0 or number % _WORTH_KEEPING != 1 or self._trouble_at > number:
            return
        made = self._made[number]
        if self.memory.is_new(made.situation):
            self.counts.gained += 1
            why = " ".join(made.answer.rpartition("\n")[0].split())
            self._remember(made.situation, made.decision, why)

    def _remember(self, situation: Situation, decision: Decision, why: str) -> None:
        number = self.memory.add(Experience(situation=situation, decision=decision, why=why))
        self.log.event(
            f"experience {number}: "
            f"{question(situation, reasons=self.model.reasons).content} -> {decision}"
        )


def _format_recalled(recalled: list[Recalled]) -> str:
    return (
        ", ".join(
            f"{each.number} ({each.distance:.2f}, {each.experience.decision})" for each in recalled
        )
        or "none"
    )


def _quote(answer: str) -> str:
    return json.dumps(answer, ensure_ascii=False)
