"""Replay: a stored run is run again from its scenario, and both runs are compared."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

from drivora_service.observations.differences.trace_difference import (
    TraceDifference,
    trace_difference,
)
from drivora_service.observations.trace import Trace
from drivora_service.oracles.verdicts.verdict_changes import verdict_changes
from drivora_service.oracles.verdicts.verdict_json import verdict_content
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import combine
from drivora_service.store.runs.run_records import RunRecord
from drivora_service.suites.replay.replay_records import (
    ComparedRun,
    Divergence,
    Replay,
    ReplayOutcome,
    VersionDifference,
)

_WITHOUT_RESULT = (
    *(RunStatus.QUEUED, RunStatus.RUNNING, RunStatus.CANCELLED),
    RunStatus.INFRASTRUCTURE_FAILED,
)
"""Statuses that say nothing about the scenario and its agents."""
_QUARANTINED = "quarantined"


@dataclass(frozen=True, slots=True, kw_only=True)
class Original:
    """A stored run that is to be replayed.

    Attributes:
        run: The run.
        network_sha256: Hash of its road network as far as it is known without a recording, or "".
    """

    run: RunRecord
    network_sha256: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """The recording of a run.

    Attributes:
        trace: Its trace; ``None`` if there is none that can be read.
        lack: Why there is none, as a clause.
        is_damaged: Whether its file is not what was recorded.
    """

    trace: Trace | None = None
    lack: str = ""
    is_damaged: bool = False


def explain_not_replayable(original: Original) -> str:
    """Returns why a run cannot be replayed, in words; "" if it can be."""
    run = original.run
    if not run.status.is_final:
        return f"it has not ended: it is {run.status}"
    if run.status in _WITHOUT_RESULT or run.cause == _QUARANTINED:
        return f"it has no result to compare with, {_describe_ending(run)}"
    if run.status is RunStatus.FINISHED and not _hash(run):
        return "the hash of its trace is not stored"
    return ""


def make_not_replayed(original: Original, reason: str) -> Replay:
    """Returns the outcome of a run that was not run again."""
    return Replay(
        run=_make_compared_run(original.run),
        outcome=ReplayOutcome.NOT_REPLAYED,
        reason=reason,
    )


def compare(original: Original, again: RunRecord, before: Recording, after: Recording) -> Replay:
    """Compares a stored run with its replay.

    Args:
        original: The stored run.
        again: The replay, which has ended.
        before: Recording of the stored run.
        after: Recording of the replay.
    """
    run = original.run
    compared = Replay(
        run=_make_compared_run(run),
        replay=_make_compared_run(again),
        outcome=ReplayOutcome.NOT_REPLAYED,
        versions=version_differences(original, again, before, after),
    )
    if again.status in _WITHOUT_RESULT or again.cause == _QUARANTINED:
        said = f": {again.error.message}" if again.error else ""
        return replace(
            compared, reason=f"its replay has no result, {_describe_ending(again)}{said}"
        )
    reasons = []
    if (run.status, run.cause) != (again.status, again.cause):
        reasons.append(
            f"it ended as {_describe_ending(run)}, its replay as {_describe_ending(again)}"
        )
    if _hash(run) != _hash(again):
        reasons.append("the hashes of the traces differ")
    difference = None
    is_placed = before.trace is not None and after.trace is not None
    if before.trace is not None and after.trace is not None:
        difference = trace_difference(before.trace, after.trace)
    if before.is_damaged:
        # The simulation may be the same, but what is stored of it is no evidence of that.
        same = "" if reasons else "; the hash of the replay is the one that was recorded"
        reasons.append(f"{before.lack}{same}")
    is_same = not reasons and difference is None
    if not is_placed and not before.is_damaged:
        reasons.append(_without_frames(original, again, before, after, is_same=is_same))
    verdicts = [[verdict_content(one) for one in each.verdicts] for each in (run, again)]
    return replace(
        compared,
        outcome=ReplayOutcome.IDENTICAL if is_same else ReplayOutcome.DIVERGED,
        reason="; ".join(reasons),
        frames_compared=is_placed,
        divergence=_divergence(difference),
        facts=difference.facts if difference else (),
        verdicts=verdict_changes(*verdicts),
    )


def version_differences(
    original: Original, again: RunRecord, before: Recording, after: Recording
) -> tuple[VersionDifference, ...]:
    """Returns what took part in a run in another version than in its replay.

    Args:
        original: The stored run.
        again: The replay.
        before: Recording of the stored run, for the hash of its road network.
        after: Recording of the replay, likewise.
    """
    run = original.run
    old = {name: str(version) for name, version in run.versions.items()}
    new = {name: str(version) for name, version in again.versions.items()}
    for versions, record in ((old, run), (new, again)):
        # Defaults of parameters belong to the version of an agent, which may not tell one.
        for ego, agent in record.agents.items():
            versions[f"agent of {ego}"] = (
                f"{agent.name} {json.dumps(dict(agent.parameters), sort_keys=True)}"
            )
    networks = (
        before.trace.network_sha256 if before.trace else original.network_sha256,
        after.trace.network_sha256 if after.trace else "",
    )
    if all(networks):
        old[f"network {run.town}"], new[f"network {run.town}"] = networks
    # A run that ended before anything was loaded, or that lost its worker, names no versions.
    names = dict.fromkeys((*old, *new)) if run.versions and again.versions else ()
    return tuple(
        VersionDifference(name=name, original=old.get(name, ""), replayed=new.get(name, ""))
        for name in names
        if old.get(name, "") != new.get(name, "")
    )


def _without_frames(
    original: Original, again: RunRecord, before: Recording, after: Recording, *, is_same: bool
) -> str:
    """Says what was compared instead of frames, and why."""
    if not _hash(original.run) and not _hash(again):
        return "there are no traces: status and cause were compared"
    lacks = "; ".join(one.lack for one in (before, after) if one.lack)
    if is_same:
        return f"the hashes were compared, not the frames: {lacks}"
    return f"no frame and actor can be named: {lacks}"


def _divergence(difference: TraceDifference | None) -> Divergence | None:
    if difference is None or difference.step is None:
        return None
    first = difference.signals[0]
    return combine(
        Divergence,
        difference,
        first,
        step=difference.step,
        actors=len({one.actor for one in difference.signals if one.actor}),
        signals=len(difference.signals),
        differences=difference.signals,
    )


def _make_compared_run(run: RunRecord) -> ComparedRun:
    return combine(ComparedRun, run, trace_sha256=_hash(run))


def _hash(run: RunRecord) -> str:
    """Returns the hash of a run's trace; older services tell only that of a recording."""
    return run.simulation_sha256 or run.trace_sha256


def _describe_ending(run: RunRecord) -> str:
    cause = f" ({run.cause})" if run.cause else ""
    return f"{run.status.replace('_', ' ')}{cause}"
