"""The prompts of the model: decision, clarification and reflection.

A model that reasons is shown examples with their reasons and may reason in text. One that does not
is shown decisions only, and answers with only a decision.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from drivora_service.agents.adapters.dilu.decisions import DECISIONS, DELIMITER, Decision
from drivora_service.agents.adapters.dilu.experiences import Experience
from drivora_service.agents.adapters.dilu.situation import (
    Situation,
    available,
    describe_situation,
    in_brief,
)

_NAMES = ", ".join(DECISIONS)
_TASK = """\
You drive a car. You are told what is around it, and decide what it does for the next second:
left or right changes the lane, accelerate or decelerate changes the wanted speed by 3 m/s, keep \
changes nothing. Speeds are in m/s. The car follows its route, keeps its distance to who is ahead \
and stops at red lights by itself."""
_ALOUD = f"""
Think in a few sentences: is there anything to gain, is it safe? Then end with one line:
Response to user:{DELIMITER} <one of {_NAMES}>"""
_AT_ONCE = "You drive a car. Answer with one of: " + _NAMES + "."


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """A message of a chat."""

    role: Literal["system", "user", "assistant"]
    content: str


def system_message(*, reasons: bool) -> Message:
    """Returns the system message.

    Args:
        reasons: Whether the model reasons in text.
    """
    return Message(role="system", content=_TASK + _ALOUD if reasons else _AT_ONCE)


def decision_messages(
    examples: Sequence[Experience], situation: Situation, *, reasons: bool
) -> list[Message]:
    """Returns the messages that ask for a decision.

    Args:
        examples: Examples to show first, in this order.
        situation: The present situation.
        reasons: Whether the model reasons in text.
    """
    messages = [system_message(reasons=reasons)]
    for example in examples:
        messages.append(question(example.situation, reasons=reasons))
        messages.append(
            Message(
                role="assistant", content=example_answer(example.decision, example.why, reasons)
            )
        )
    asked = question(situation, reasons=reasons)
    if reasons:
        asked = Message(role="user", content=f"{asked.content} {_available(situation)}")
    return [*messages, asked]


def example_answer(decision: Decision, why: str, reasons: bool) -> str:
    """Returns the answer of an example."""
    return f"{why}\nResponse to user:{DELIMITER} {decision}" if reasons else str(decision)


def check_messages(answer: str) -> list[Message]:
    """Returns the messages that ask for the decision of an unclear answer, as in DiLu."""
    return [
        Message(
            role="user",
            content=f"Somebody was asked to decide how to drive and answered:\n{answer}\n\n"
            f"Which one of {_NAMES} is meant? Answer with nothing but:\n{DELIMITER} <the word>",
        )
    ]


def reflection_messages(
    situation: Situation, decision: Decision, answer: str, *, reasons: bool
) -> list[Message]:
    """Returns the messages that ask for a correction of a decision that led to hard braking."""
    request = (
        f"After that the car had to brake hard, so {decision} was wrong. What should you have "
        "decided?"
    )
    if reasons:
        request += (
            " Find the mistake in your reasoning and say in a sentence how to avoid it; end as "
            "before."
        )
    return [
        system_message(reasons=reasons),
        question(situation, reasons=reasons),
        Message(role="assistant", content=answer),
        Message(role="user", content=request),
    ]


def _available(situation: Situation) -> str:
    return f"Available now: {', '.join(available(situation))}."


def question(situation: Situation, *, reasons: bool) -> Message:
    """Returns the message that describes a situation."""
    return Message(
        role="user", content=describe_situation(situation) if reasons else in_brief(situation)
    )
