"""A stored run and its replay, compared, as values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.observations.differences.compared_signals import Value
from drivora_service.observations.differences.fact_differences import FactDifference
from drivora_service.observations.differences.trace_difference import SignalDifference
from drivora_service.oracles.verdicts.verdict_changes import VerdictChange
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape


class ReplayOutcome(StrEnum):
    """The outcome of a replay."""

    IDENTICAL = "identical"
    """The same trace, bit for bit; without one, the same status and cause."""
    DIVERGED = "diverged"
    """Another trace, status or cause."""
    NOT_REPLAYED = "not_replayed"
    """It could not be run again, or there is nothing to compare with."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedRun(Shape):
    """A run as a replay compares it.

    Attributes:
        configuration: The ADS with the parameters that differ from its defaults.
        configuration_id: Short id of the ADS with all its parameters; empty if not recorded.
        cause: Why it was not judged; empty otherwise.
        trace_sha256: Hash of its trace, also where nothing was recorded; empty without one.
        steps: Rows of the trace; null without one.
    """

    id: str
    label: str
    configuration: str
    configuration_id: str
    status: RunStatus
    cause: str
    trace_sha256: str
    steps: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence(Shape):
    """The first difference of the frames of two runs.

    Attributes:
        step: First row of the traces that differs.
        time: Its simulation time, seconds.
        actor: First actor that differs in it, or traffic light; empty for the whole trace.
        signal: Its first signal that differs; see `differences`.
        original: Value in the original run; null: not present or not applicable.
        replayed: Value in the replay, likewise.
        actors: Number of actors and traffic lights that differ in this row.
        signals: Number of signals that differ in this row, those of all actors.
        differences: All that differs in this row, causes before effects.
    """

    step: int
    time: float | None
    actor: str
    signal: str
    original: Value
    replayed: Value
    actors: int
    signals: int
    differences: tuple[SignalDifference, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionDifference(Shape):
    """A version that was another one in the replay.

    Attributes:
        name: Package, agent, or `network` with its name.
        original: Version, or hash of the network, in the original run; empty: none.
        replayed: In the replay, likewise.
    """

    name: str
    original: str
    replayed: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay(Shape):
    """A stored run and its replay, compared.

    Attributes:
        run: The stored run.
        replay: The new run; null if there is none.
        reason: Why they differ or could not be compared; remarks; empty if there is nothing to say.
        frames_compared: Whether both recordings were there, so that all frames were compared.
        divergence: First difference of the frames; null without one, or if it cannot be placed.
        facts: What else differs between the recordings, apart from frames.
        versions: Versions that differ, which may explain a divergence.
        verdicts: Oracles whose verdicts differ.
        files: Recordings that were written, of the stored run and of the replay.
    """

    run: ComparedRun
    replay: ComparedRun | None = None
    outcome: ReplayOutcome
    reason: str = ""
    frames_compared: bool = False
    divergence: Divergence | None = None
    facts: tuple[FactDifference, ...] = ()
    versions: tuple[VersionDifference, ...] = ()
    verdicts: tuple[VerdictChange, ...] = ()
    files: tuple[str, ...] = ()
