"""The contents of messages between a slot, its keeper and its worker, as validated JSON."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticSerializationError

from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.report_encoding import report_from_json, report_to_message
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.shapes import adapter, to_json
from drivora_service.worker.channel import LONGEST_BODY, Frame, Kind, ProtocolError

_WORKER_STATUSES = frozenset(
    {
        RunStatus.FINISHED,
        RunStatus.INVALID,
        RunStatus.AGENT_FAILED,
        RunStatus.PLUGIN_FAILED,
        RunStatus.SIMULATOR_CRASHED,
        RunStatus.INFRASTRUCTURE_FAILED,
    }
)
_REPORT_BEGIN = b'{"run_id":"%s","status":"%s"'
_CAUSE = re.compile(r"[a-z][a-z0-9_]{0,39}")
_SHA256 = re.compile(r"([0-9a-f]{64})?")
_MOST_STEPS = 2**31 - 1
"""Largest value of an INTEGER column of the database."""
_MAX_TEXT = 300
"""Number of characters of an error that are quoted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NotReady:
    """A worker cannot be set up and ends.

    Attributes:
        reason: What was found and, if known, what to do.
    """

    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Started:
    """A keeper has started its worker."""

    pid: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """A worker has ended.

    Attributes:
        exit_code: The negative number of the signal that ended it, if one did.
    """

    exit_code: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Leftovers:
    """Live processes that were started in the worker, those of ADSs left out.

    Attributes:
        names: Their names, each with its process id.
    """

    names: tuple[str, ...]


_TYPES: dict[Kind, type[NotReady | Started | Ended | Leftovers]] = {
    Kind.NOT_READY: NotReady,
    Kind.STARTED: Started,
    Kind.ENDED: Ended,
    Kind.LEFTOVERS: Leftovers,
}


def frame_of(message: NotReady | Started | Ended | Leftovers) -> Frame:
    """Returns a message as a frame with its fields as JSON."""
    kind = next(kind for kind, type_ in _TYPES.items() if isinstance(message, type_))
    fields = {name: getattr(message, name) for name in type(message).__slots__}
    return Frame(kind, json.dumps(fields).encode())


def message_of(frame: Frame) -> NotReady | Started | Ended | Leftovers:
    """Returns the message of a frame.

    Raises:
        ProtocolError: It is no message of these kinds.
    """
    if frame.kind not in _TYPES:
        raise ProtocolError(f"the message {frame.kind.name} was not expected")
    try:
        return _adapter(frame.kind).validate_json(frame.body)
    except ValidationError as error:
        raise ProtocolError(f"the message {frame.kind.name} is not as agreed: {error}") from None


@cache
def _adapter(kind: Kind) -> TypeAdapter[NotReady | Started | Ended | Leftovers]:
    return TypeAdapter(_TYPES[kind])


def note_of_candidate(candidate: Candidate, run_id: str) -> bytes:
    """Writes the candidate of a run, as a note on the worker's board."""
    return run_id.encode() + b"\n" + to_json(Candidate, candidate)


def candidate_of(note: bytes, source: CandidateSource, run_id: str) -> Candidate | None:
    """Reads the candidate of a run.

    Args:
        note: The note on the worker's board.
        source: The genes that it was given.
        run_id: The run that it was given.

    Returns:
        The candidate; ``None`` if the note is that of a run before, or there is none.

    Raises:
        ProtocolError: It is no candidate of these genes.
    """
    run, _, body = note.partition(b"\n")
    if run != run_id.encode():
        return None
    try:
        candidate: Candidate = adapter(Candidate).validate_json(body)
    except ValidationError as error:
        raise ProtocolError(f"an invalid candidate: {error}"[:_MAX_TEXT]) from None
    if len(candidate.values) != len(source.values):
        raise ProtocolError(
            f"a candidate of {len(candidate.values)} genes; asked were {len(source.values)}"
        )
    if not all(map(math.isfinite, (*candidate.values, candidate.prepare_s))):
        raise ProtocolError("a candidate with a number that is not finite")
    if bool(candidate.document) == bool(candidate.problem):
        raise ProtocolError("a candidate with both or neither of a scenario and a problem")
    return candidate


def frame_of_report(report: RunReport) -> Frame:
    """Writes a report; one that cannot be sent becomes a failure with the reason."""
    try:
        body = report_to_message(report)
        problem = f"it takes {len(body)} bytes; allowed: {LONGEST_BODY}"
        if len(body) <= LONGEST_BODY:
            return Frame(Kind.REPORT, body)
    except (PydanticSerializationError, ValueError, TypeError, RecursionError) as error:
        if report.failure is not None:
            # Such as an undecodable file name in the message of an agent's error.
            plain = _failure_report(report.run_id, report.status, _as_text(report.failure))
            return Frame(Kind.REPORT, report_to_message(plain))
        problem = f"{type(error).__name__}: {error}"
    failure = _as_text(
        RunFailure(
            cause="unwritable_report",
            message=f"the report of the {report.status} run cannot be sent: {problem}"[:_MAX_TEXT],
        )
    )
    plain = _failure_report(report.run_id, RunStatus.INFRASTRUCTURE_FAILED, failure)
    return Frame(Kind.REPORT, report_to_message(plain))


def _failure_report(run_id: str, status: RunStatus, failure: RunFailure) -> RunReport:
    return RunReport(run_id=run_id, status=status, failure=failure)


def _as_text(failure: RunFailure) -> RunFailure:
    def text(value: str) -> str:
        return value.encode(errors="replace").decode()

    return RunFailure(
        cause=failure.cause, message=text(failure.message), log=text(failure.log[-_LONGEST_LOG:])
    )


_LONGEST_LOG = 1 << 20


def is_of_finished_run(frame: Frame, run_id: str) -> bool:
    """Returns whether a message begins as the report of a finished run does.

    Args:
        frame: The worker's message.
        run_id: The run that it was given.
    """
    begin = _REPORT_BEGIN % (run_id.encode(), RunStatus.FINISHED.encode())
    return frame.kind is Kind.REPORT and frame.body.startswith(begin)


def report_of(frame: Frame, run_id: str) -> RunReport:
    """Reads the report of a run.

    Args:
        frame: The worker's message.
        run_id: The run that it was given.

    Raises:
        ProtocolError: It is no report of this run that a worker may send.
    """
    if frame.kind is not Kind.REPORT:
        raise ProtocolError(f"the message {frame.kind.name} where a report was expected")
    try:
        report = report_from_json(frame.body)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise ProtocolError(f"an invalid report: {place}: {first['msg']}"[:_MAX_TEXT]) from None
    problem = next(_problems(report, run_id), "")
    if problem:
        raise ProtocolError(f"a report with {problem}"[:_MAX_TEXT])
    return report


def _problems(report: RunReport, run_id: str) -> Iterator[str]:
    if report.run_id != run_id:
        yield f"the run id {report.run_id!r}; asked was {run_id!r}"
    if report.status not in _WORKER_STATUSES:
        yield f"the status {report.status}, which no worker reports"
    if report.status is not RunStatus.FINISHED and report.failure is None:
        yield f"the status {report.status} and no failure"
    if report.failure is not None and not _CAUSE.fullmatch(report.failure.cause):
        yield f"the cause {report.failure.cause!r}"
    for digest in (report.trace_sha256, report.egos_sha256):
        if not _SHA256.fullmatch(digest):
            yield f"the hash {digest!r}"
    if any(gene < 0 for gene in report.without_effect):
        yield f"the genes {report.without_effect}"
    if not 0 <= report.steps <= _MOST_STEPS:
        yield f"{report.steps} steps"
    for name in ("sim_time_s", "wall_time_s", "step_cost_us"):
        value: float = getattr(report, name)
        if not math.isfinite(value):
            yield f"{name} {value}"
    for verdict in report.verdicts:
        if verdict.time is not None and not math.isfinite(verdict.time):
            yield f"a verdict at the time {verdict.time}"
        if verdict.step is not None and not abs(verdict.step) <= _MOST_STEPS:
            yield f"a verdict at step {verdict.step}"
