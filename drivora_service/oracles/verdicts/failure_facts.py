"""The facts of a violation: its group, the other actor, the manoeuvre, and one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability

_SEPARATOR = "|"

_ROLES = {
    "ego": "another ego",
    "npc_vehicle": "a vehicle",
    "npc_walker": "a walker",
    "npc_obstacle": "an obstacle",
    "background": "a vehicle of the background traffic",
}
"""Other actors in words, by their role."""

_WAYS = ("rule", "front_crossed_on", "reason")
"""Evidence that tells the manoeuvre by one of a few words; the first that an oracle has. The
``reason`` of a collision, beside a ``rule``, is a clause of words."""

_JUDGED_ENDS = {"collision": "collision", "stuck": "blocked", "route_deviation": "route_deviation"}
"""The oracles that judge ends of an ego's part, for verdicts from before ``follows``."""


def relation(evidence: Mapping[str, Any]) -> str:
    """Returns the relation of the other actor to the ego from an oracle's evidence, or "".

    For a collision it is the role of the other actor and the touched part of the ego; for a
    deadlock, the number of actors that wait for one another.
    """
    cycle = evidence.get("cycle")
    if isinstance(cycle, list | tuple):
        return f"cycle of {len(cycle)}"
    role, face = evidence.get("counterpart_role"), evidence.get("face")
    if role and face:
        return f"{role}, {face}"
    return str(role or face or "")


def manoeuvre(evidence: Mapping[str, Any]) -> str:
    """Returns the manoeuvre from an oracle's evidence in one word, or "".

    For a collision it is the rule of responsibility that applied, such as ``following`` or
    ``right_of_way``.
    """
    for name in _WAYS:
        if told := evidence.get(name):
            return str(told)
    return ""


def followed_oracle(verdict: Verdict) -> str:
    """Returns the oracle from whose violation this one only follows; "" if from none.

    Verdicts of versions that did not record it follow where a destination was missed because a
    collision, standing or leaving the route ended the ego's part.
    """
    if verdict.follows or verdict.oracle != "destination":
        return verdict.follows
    return _JUDGED_ENDS.get(str(verdict.evidence.get("reason")), "")


def failure_group(verdict: Verdict) -> str:
    """Returns the group of a violation: the same on all road networks and in all campaigns.

    It names the oracle, the relation of the other actor to the ego, and the manoeuvre:
    ``collision|npc_walker, front|pedestrian``.
    """
    parts = (verdict.oracle, relation(verdict.evidence), manoeuvre(verdict.evidence))
    return _SEPARATOR.join(filter(None, parts))


def failure_sentence(verdict: Verdict, *, town: str, kind: str = "") -> str:
    """Returns one sentence with the facts of a violation.

    Args:
        verdict: The violation.
        town: Name of the road network.
        kind: Its kind, which names the place (see ``campaigns.search.failure_kinds``); "": the
            place is told by its coordinates.
    """
    where = _place(verdict, town, kind)
    account = _account(verdict)
    parts = (f"{_what(verdict)}, {where}", _chain(verdict), account)
    return f"{'; '.join(part for part in parts if part)}."


def avoidable_until(verdict: Verdict) -> float | None:
    """Returns the last moment at which braking would have avoided a violation, simulation time.

    ``None`` if it was not avoidable, or that is not measurable or not known.
    """
    before = _assessed(verdict).get("latest_before")
    if verdict.avoidable is not Answer.YES or before is None or verdict.time is None:
        return None
    return verdict.time - float(before)


def avoidability_words(verdict: Verdict) -> str:
    """Returns until when a violation was avoidable, or that it was not; "" if this is not judged.

    Words of a sentence: ``avoidable until 4.25 s``.
    """
    assessed = _assessed(verdict)
    match verdict.avoidable:
        case Answer.YES:
            until = avoidable_until(verdict)
            return "avoidable" if until is None else f"avoidable until {until:.2f} s"
        case Answer.NO:
            shown = assessed.get("risk_perceived_before")
            why = "" if shown is None else f": the danger showed {float(shown):.1f} s before"
            return f"not avoidable{why}"
        case Answer.NOT_MEASURABLE:
            unknown = assessed.get("not_measurable")
            return "not measurable whether avoidable" + (f": {unknown}" if unknown else "")
        case _:
            return ""


def full_message(verdict: Verdict) -> str:
    """Returns the message of a verdict, and of a violation until when it was avoidable."""
    words = avoidability_words(verdict) if verdict.outcome is Outcome.VIOLATED else ""
    return f"{verdict.message} {words[0].upper()}{words[1:]}." if words else verdict.message


def explain_collision(reason: str, chain: str | None) -> str:
    """Returns why a collision came about: the reason, and then the chain of events that led to it.

    The reason is left out where it is an event of the chain, which has its time.
    """
    if not chain:
        return reason
    return chain if reason in chain else f"{reason}. {chain[0].upper()}{chain[1:]}"


def _assessed(verdict: Verdict) -> Mapping[str, Any]:
    """Returns the evidence on the avoidability of a violation; empty if there is none."""
    assessed = verdict.evidence.get("avoidability")
    return assessed if isinstance(assessed, Mapping) else {}


def _chain(verdict: Verdict) -> str:
    return str(_assessed(verdict).get("chain") or "")


def _what(verdict: Verdict) -> str:
    evidence = verdict.evidence
    # The speed of the message: that of the ego alone would be another one for the same failure.
    role, speed = evidence.get("counterpart_role"), evidence.get("relative_speed")
    if verdict.oracle != "collision" or role is None or speed is None:
        return verdict.message.strip().rstrip(".") or f"Violated {verdict.oracle}"
    face, reason = evidence.get("face"), evidence.get("reason")
    if reason and str(reason) in _chain(verdict):
        # It follows, with its time.
        reason = ""
    touched = f" ({face} of the ego)" if face else ""
    return (
        f"Collided with {_ROLES.get(str(role), str(role))} at {float(speed):.1f} m/s relative to it"
        f"{touched}{f': {reason}' if reason else ''}"
    )


def _place(verdict: Verdict, town: str, kind: str) -> str:
    # The second part of a kind is the place, if the oracle told one.
    parts = kind.split(_SEPARATOR)
    place = parts[1] if len(parts) > 1 else ""
    if place.startswith("junction "):
        return f"at {place} of {town}"
    if place.startswith("road "):
        return f"on {place} of {town}"
    if verdict.location is None:
        return f"on {town}"
    x, y = verdict.location
    return f"at ({x:.1f} m, {y:.1f} m) of {town}"


_ACCOUNTS = {
    Accountability.AVOIDABLE: "the fault of the ego",
    Accountability.NOT_MEASURABLE: (
        "the fault of the ego; whether it was avoidable is not measurable"
    ),
    Accountability.UNAVOIDABLE: "the fault of the ego, not avoidable once the danger showed",
    Accountability.UNDETERMINED: "fault undetermined",
    Accountability.NOT_JUDGED: "",
    Accountability.PREVENTABLE: "not the fault of the ego, but avoidable",
    Accountability.NOT_AT_FAULT: "not the fault of the ego",
}
"""Clauses of a sentence, by what an ego is accountable for."""


def _account(verdict: Verdict) -> str:
    until, degree = avoidable_until(verdict), accountability(verdict)
    if until is not None and degree is Accountability.PREVENTABLE:
        return f"{_ACCOUNTS[degree]} until {until:.2f} s"
    told = (
        _ACCOUNTS[degree],
        "" if until is None else f"avoidable until {until:.2f} s",
    )
    return ", ".join(part for part in told if part)
