"""Assessment of a collision: the risk perception point, and whether it was avoidable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from drivora_service.errors import UnknownName
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.recorded_conditions import frictions_under, perception_ranges
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol, Role, Trace
from drivora_service.oracles.avoidability.braking_evasion import (
    brakes_clear,
    careful_braking,
    instant_braking,
)
from drivora_service.oracles.avoidability.breach import (
    BREACH_IN_WORDS,
    Breach,
    OwnBreach,
    find_own_breach,
)
from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver
from drivora_service.oracles.avoidability.evasion import find_evasion
from drivora_service.oracles.avoidability.replayed_contact import Replay, cut_out, slow_down
from drivora_service.oracles.avoidability.risk import RISK_IN_WORDS, Perceived, perceive_risk
from drivora_service.oracles.verdict import Answer
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model

_KINDS = {Role.NPC_WALKER: ActorKind.WALKER, Role.NPC_OBSTACLE: ActorKind.OBSTACLE}
_HEIGHTS = {ActorKind.VEHICLE: 1.5, ActorKind.WALKER: 1.7, ActorKind.OBSTACLE: 1.0}
"""Height of actors of unknown model, metres."""

_MAX_STEER = 0.6
"""Steering angle of vehicles of unknown model, radians."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Avoidability:
    """Whether a collision was avoidable.

    Attributes:
        avoidable: Whether the careful and competent driver avoids it.
        physically_avoidable: Whether full braking and steering without delay, from the risk
            perception point on, avoid it.
        evidence: Measured values by name, SI units.
    """

    avoidable: Answer
    physically_avoidable: Answer
    evidence: Mapping[str, Any]


def assess(
    ego: EgoView,
    k: int,
    counterpart: int,
    driver: CarefulDriver | None = None,
    *,
    manoeuvre: int | None = None,
) -> Avoidability:
    """Assesses a collision by replay of the others' recorded motion.

    Args:
        ego: The ego.
        k: Its row at the contact.
        counterpart: Row in the trace of the actor that it touched.
        driver: The careful driver; by default that of the regulation.
        manoeuvre: The ego's row in which it came into the way of the other by a manoeuvre for which
            it is responsible; None without one.
    """
    driver = driver or CarefulDriver()
    under = frictions_under(ego.trace, ego.actor, ego.first, ego.states[: k + 1])
    if np.isnan(under).any():
        return _unknown("the trace does not record the grip of the road")
    if k < 1:
        return _unknown("the contact is in the ego's first row: nothing is recorded before it")
    replay = cut_out(ego, k, counterpart)
    grip = replay.friction * GRAVITY
    under = under[-replay.contact - 1 :]
    model = _model(ego.trace, ego.row)
    brakes = model.max_deceleration if model is not None else np.inf
    perceived = perceive_risk(
        replay,
        ego.trace,
        ego.row,
        driver,
        # Where the way is slippery, braking takes longer, and the driver looks farther ahead.
        grip=float(under.min()) * GRAVITY,
        heights=_heights(ego.trace),
        sight=perception_ranges(ego.trace, replay.first, replay.contact),
    )
    full = driver.full_braking(grip, brakes)
    start = k - replay.contact

    def in_time_at_limit() -> bool:
        limits = ego.value(EgoCol.SPEED_LIMIT)[start : k + 1]
        slower = slow_down(replay, perceived.row, limits)
        return brakes_clear(
            slower, perceived.row, delay=driver.delay, full=full, grip=grip, jerk=driver.jerk
        )

    breach = find_own_breach(
        ego,
        k,
        counterpart,
        start + perceived.row,
        in_time_at_limit=in_time_at_limit,
        manoeuvre=manoeuvre,
        was_hidden=perceived.hidden,
    )
    # An ego in breach is assumed to know the risk from the start of the record on.
    since = perceived.row if breach is None else 0
    latest = careful_braking(replay, driver, grip, brakes)
    # No braking helps an ego on the wrong side against what comes towards it, nor one that moved
    # before another; but the careful driver does neither.
    went_astray = breach is not None and breach.kind is Breach.OFF_ITS_SIDE and breach.row > 0
    stayed = (manoeuvre is not None and manoeuvre > 0) or (went_astray and replay.oncoming > 0.0)
    avoidable = (latest >= since and latest >= 0) or stayed
    physically = avoidable or _physically(
        ego, replay, max(since, 0) if breach is None else perceived.row, grip, brakes, model
    )
    friction = float(under[perceived.row :].min())
    return Avoidability(
        avoidable=Answer.YES if avoidable else Answer.NO,
        physically_avoidable=Answer.YES if physically else Answer.NO,
        evidence=_evidence(replay, perceived, breach, k, latest, friction),
    )


def _unknown(reason: str) -> Avoidability:
    return Avoidability(
        avoidable=Answer.NOT_MEASURABLE,
        physically_avoidable=Answer.NOT_MEASURABLE,
        evidence={"not_measurable": reason},
    )


def _physically(
    ego: EgoView, replay: Replay, row: int, grip: float, brakes: float, model: ActorModel | None
) -> bool:
    if instant_braking(replay, grip, brakes, row) >= 0:
        return True
    evasion = find_evasion(
        replay,
        ego.network,
        min(row, replay.contact - 1),
        grip=grip,
        brakes=brakes,
        wheelbase=replay.wheelbase,
        max_steer=model.max_steer if model is not None else _MAX_STEER,
    )
    return evasion is not None


def _evidence(
    replay: Replay,
    perceived: Perceived,
    breach: OwnBreach | None,
    k: int,
    latest: int,
    friction: float,
) -> dict[str, Any]:
    """Returns the evidence: the decisive moments in seconds before the contact, and the reasons.

    ``k`` is the ego's row at the contact; ``friction`` is the least that the ego had from the
    perception of the risk on.
    """

    def before(row: int) -> float:
        return round((replay.contact - row) * replay.step, 6)

    risk = None if perceived.risk is None else str(perceived.risk)
    return {
        "risk": risk,
        "risk_perceived_before": None if risk is None else before(perceived.row),
        "was_hidden": perceived.hidden,
        "own_breach": None if breach is None else str(breach.kind),
        "own_breach_before": (None if breach is None else round((k - breach.row) * replay.step, 6)),
        "chain": _chain(replay, perceived, breach, k),
        "latest_before": None if latest < 0 else before(latest),
        "friction": friction,
    }


def _chain(replay: Replay, perceived: Perceived, breach: OwnBreach | None, k: int) -> str | None:
    """Returns the breach and the danger that it led to, in words; None without a breach."""
    if breach is None:
        return None
    events = [((k - breach.row) * replay.step, f"the ego {BREACH_IN_WORDS[breach.kind]}")]
    if perceived.risk is not None:
        danger = (replay.contact - perceived.row) * replay.step
        events.append((danger, RISK_IN_WORDS[perceived.risk]))
    # The longest ago first: a driver who looks ahead may see the danger before the breach.
    events.sort(key=lambda event: -event[0])
    return "; ".join(f"{before:.1f} s before, {what}" for before, what in events)


def _model(trace: Trace, row: int) -> ActorModel | None:
    actor = trace.actors[row]
    return _known_model(_KINDS.get(actor.role, ActorKind.VEHICLE), actor.model)


def _heights(trace: Trace) -> FloatArray:
    heights = []
    for actor in trace.actors:
        kind = _KINDS.get(actor.role, ActorKind.VEHICLE)
        model = _known_model(kind, actor.model)
        heights.append(_HEIGHTS[kind] if model is None else model.height)
    return np.array(heights)


@lru_cache(maxsize=512)
def _known_model(kind: ActorKind, name: str) -> ActorModel | None:
    try:
        return actor_model(kind, name)
    except UnknownName:
        return None
