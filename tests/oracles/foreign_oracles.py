"""Oracles of a package: one that judges, and ones that go wrong when the ego is called so."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col
from drivora_service.oracles.plugin import OraclePlugin
from drivora_service.oracles.verdict import Oracle, Verdict, not_started, passed, violated


@dataclass(frozen=True, slots=True, kw_only=True)
class TopSpeed:
    """Violated where the ego is fast, and once for the whole run.

    Attributes:
        limit: m/s.
    """

    limit: float = 5.0

    @property
    def name(self) -> str:
        return "top_speed"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        return tuple(self._judge(ego) for ego in run.egos)

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        k = int(np.argmax(ego.speed > self.limit))
        if ego.speed[k] <= self.limit:
            return passed(self.name, ego, "Kept below the limit.")
        return violated(self.name, ego, k, "Was fast.", at_fault=True, top=np.max(ego.speed))


class Moody(TopSpeed):
    """Does to its worker what the name of the first ego says."""

    @property
    def name(self) -> str:
        return "moody"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        mood = MOODS.get(run.egos[0].id)
        good = TopSpeed.judge(self, run)
        return good if mood is None else mood(run, good)


def raises(run: RunView, good: tuple[Verdict, ...]) -> Any:
    raise ZeroDivisionError("in a bad mood")


def leaves(run: RunView, good: tuple[Verdict, ...]) -> Any:
    sys.exit(3)


def writes(run: RunView, good: tuple[Verdict, ...]) -> Any:
    run.trace.states[:, 0, Col.X] += 100.0
    run.egos[0].proximity.time_to_collision[:] = 0.0
    return good


def _changed(**fields: Any) -> Callable[[RunView, tuple[Verdict, ...]], Any]:
    return lambda run, good: tuple(replace(verdict, **fields) for verdict in good)


MOODS: dict[str, Callable[[RunView, tuple[Verdict, ...]], Any]] = {
    "raises": raises,
    "leaves": leaves,
    "writes": writes,
    "nothing": lambda run, good: None,
    "list": lambda run, good: list(good),
    "nobody": lambda run, good: (),
    "words": lambda run, good: ("fine",),
    "both": lambda run, good: (*good, passed("moody", run.egos[0], "Kept.")),
    "collision": _changed(oracle="collision"),
    "stranger": _changed(ego="ego_9"),
    "silent": _changed(message=""),
    "placeless": _changed(location=None),
    "timeless": _changed(time=float("nan")),
    "late": _changed(step=10**6),
    "negative": _changed(step=-1),
    "unmeasured": _changed(evidence={"violation_magnitude": {"name": "gap"}}),
    "unsure": _changed(outcome="perhaps"),
    "soon": _changed(time="soon"),
    "object": _changed(evidence={"run": object()}),
    "code": _changed(evidence={"why": raises}),
}


@dataclass(frozen=True, kw_only=True)
class Peculiar(TopSpeed):
    """Has thresholds that JSON has not."""

    table: Any = np.int64
    never: float = field(init=False)

    @property
    def name(self) -> str:
        return "peculiar"


def broken() -> Oracle:
    raise RuntimeError("no such file")


def _named(name: str, create: Callable[[], Any]) -> OraclePlugin:
    return OraclePlugin(name=name, description="an oracle of a package", create=create)


top_speed = _named("top_speed", TopSpeed)
moody = _named("moody", Moody)
peculiar = _named("peculiar", Peculiar)
collision = _named("collision", TopSpeed)
not_a_plugin = TopSpeed()
misnamed = _named("other", TopSpeed)
liar = _named("liar", TopSpeed)
unmade = _named("unmade", broken)
judgeless = _named("judgeless", lambda: "judge")
Shouting = _named("Shouting", TopSpeed)
