"""Every error that Drivora raises on purpose.

The tree::

    DrivoraError
    ├── InvalidDocument        a document cannot be used; carries every problem at once
    ├── UnknownName            a network, agent, model, oracle or run that does not exist
    ├── NetworkError           a road network cannot be read, imported or driven as asked
    │   ├── NoRoute            no drivable route between two places
    │   └── NetworkTaken       another network has the name
    ├── AgentError             an ADS raised, gave an invalid answer, hung or died
    ├── PluginError            code of a package cannot be loaded, raised or answered invalidly
    │   └── OracleError        it is an oracle
    ├── SimulatorError         libsumo refused a call that should have worked
    ├── WorkersCannotStart     no worker process can be started
    ├── SearchError            a gene space or a tester cannot be used as requested
    │   └── UnknownObjective   a tester asked for an objective that was not measured
    ├── CampaignError          a campaign cannot be started, resumed or compared
    ├── StoreError             the database or a trace file cannot be used
    │   ├── StoreUnavailable   the database cannot be used at the moment
    │   │   └── StoreDamaged   it is damaged, and must be restored
    │   ├── TraceDamaged       the trace file of a run is not the one that was recorded
    │   ├── Conflict           the request conflicts with the stored state
    │   ├── NothingStored      there is no database where one is to be read
    │   └── QueueFull          the queue has reached its limit
    ├── AddressTaken           another process has the address that a server is to listen on
    ├── ServiceBroken          this process can no longer serve and must be restarted
    ├── ServiceError           a service refused an HTTP request, or did not answer
    │   ├── NotAuthorised      it needs a token, or one with another scope
    │   ├── NotFound           the requested object does not exist
    │   ├── RequestConflict    the request conflicts with its stored state
    │   └── ServiceUnavailable it did not answer, or cannot answer at the moment
    └── ConfigurationError     a setting cannot be used
        └── CredentialsUnusable  the file of the API tokens or of the sessions cannot be used
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from drivora_service.known_names import unknown_name_message


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One problem of a document, with its place.

    Attributes:
        pointer: JSON pointer (RFC 6901) to the place in the document; "" is the whole document.
        code: Short stable name of the kind of problem, such as ``off_network``.
        message: What was found, what is allowed and what to do, in one or two sentences.
    """

    pointer: str
    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FurtherProblems(Problem):
    """Problems that are not listed, because there are many.

    Attributes:
        count: Number of those that are known.
        stopped: Whether the rest of the document was not checked, so that there may be more.
    """

    count: int
    stopped: bool = False


def further_problems(count: int, *, stopped: bool = False) -> FurtherProblems:
    """Returns the last entry of a list from which ``count`` known problems are left out."""
    known = f"{count} further problems are not listed" if count else ""
    unknown = "the rest of the document was not checked" if stopped else ""
    return FurtherProblems(
        pointer="",
        code="more_problems",
        message="; ".join(part for part in (known, unknown) if part),
        count=count,
        stopped=stopped,
    )


def count_problems(problems: Iterable[Problem]) -> int:
    """Returns the number of problems, with those that are not listed."""
    return sum(one.count if isinstance(one, FurtherProblems) else 1 for one in problems)


class DrivoraError(Exception):
    """Base of every error that Drivora raises on purpose."""


class InvalidDocument(DrivoraError):
    """A document cannot be used; every problem in it is named.

    Attributes:
        problems: Never empty, in document order.
    """

    def __init__(self, problems: tuple[Problem, ...]) -> None:
        self.problems = problems
        lines = [f"{p.pointer or '/'}: {p.message}" for p in problems]
        super().__init__("\n".join(lines))


class UnknownName(DrivoraError):
    """A name is not in its catalogue."""

    def __init__(self, kind: str, name: str, known: tuple[str, ...], hint: str = "") -> None:
        self.kind, self.name, self.known, self.hint = kind, name, known, hint
        message = unknown_name_message(kind, name, known)
        super().__init__(f"{message}. {hint}" if hint else message)

    def __reduce__(self) -> tuple[type[UnknownName], tuple[str, str, tuple[str, ...], str]]:
        return type(self), (self.kind, self.name, self.known, self.hint)


class AmbiguousName(DrivoraError):
    """A name, or the beginning of an id, means several stored things.

    Attributes:
        candidates: A line each, with the id, the time of creation and the name.
    """

    def __init__(self, message: str, candidates: tuple[str, ...]) -> None:
        self.message, self.candidates = message, candidates
        super().__init__("\n".join((message, *candidates)))

    def __reduce__(self) -> tuple[type[AmbiguousName], tuple[str, tuple[str, ...]]]:
        return type(self), (self.message, self.candidates)


class NetworkError(DrivoraError):
    """A road network cannot be read, imported or driven as requested."""


class NoRoute(NetworkError):
    """There is no drivable route between two places of a network."""


class NetworkTaken(NetworkError):
    """Another network has the name under which one is to be imported.

    Attributes:
        is_shipped: Whether it comes with Drivora, so that it cannot be replaced.
    """

    def __init__(self, message: str, *, is_shipped: bool = False) -> None:
        self.is_shipped = is_shipped
        super().__init__(message)


class AgentError(DrivoraError):
    """An ADS raised, gave an invalid answer, hung or died.

    Attributes:
        cause: Short stable name: ``agent_raised``, ``agent_invalid_control``, ``agent_hung``,
            ``agent_died``, ``agent_killed`` (without a known fault of its own),
            ``agent_unreachable``, ``agent_protocol``, ``agent_not_installed``,
            ``agent_changed_service``.
        log: The last lines of its log or its traceback.
    """

    def __init__(self, message: str, *, cause: str = "agent_raised", log: str = "") -> None:
        self.cause, self.log = cause, log
        super().__init__(message)


class PluginError(DrivoraError):
    """Code of an installed package cannot be loaded, raised or gave an invalid answer.

    Attributes:
        cause: Short stable name: ``feedback_plugin``, ``feedback_raised``,
            ``feedback_invalid_measurement``, ``metric_plugin``, ``metric_raised``,
            ``metric_invalid_value``, ``tester_raised``, ``tester_out_of_memory``, and those of
            oracles.
        log: The end of its traceback.
    """

    def __init__(self, message: str, *, cause: str, log: str = "") -> None:
        self.cause, self.log = cause, log
        super().__init__(message)


class OracleError(PluginError):
    """An oracle of an installed package cannot be loaded, raised or gave an invalid answer.

    Attributes:
        cause: Short stable name: ``oracle_plugin``, ``oracle_raised``, ``oracle_invalid_verdict``.
        log: The end of its traceback.
    """

    def __init__(self, message: str, *, cause: str = "oracle_raised", log: str = "") -> None:
        super().__init__(message, cause=cause, log=log)


class SimulatorError(DrivoraError):
    """libsumo refused a call that should have worked."""


class WorkersCannotStart(DrivoraError):
    """No worker process can be started: a fault of the machine or installation, not of a run."""


class SearchError(DrivoraError):
    """A gene space or a tester cannot be used as requested."""


def closest_name(name: str, known: Sequence[str]) -> str:
    """Returns the known name that is probably meant by an unknown one; "" if none is near.

    Abbreviations are understood as well: ``min_ttc`` for ``min_time_to_collision_s``.
    """
    close = difflib.get_close_matches(name, known, n=1)
    if close:
        return close[0]
    first, _, rest = name.partition("_")
    alike = [
        one for one in known if rest and one.partition("_")[0] == first and _has_letters(one, rest)
    ]
    return min(alike, key=len, default="")


def _has_letters(text: str, letters: str) -> bool:
    """Returns whether a text has some letters in their order."""
    left = iter(text.partition("_")[2])
    return all(letter in left for letter in letters.replace("_", ""))


class UnknownObjective(SearchError):
    """A tester asked for an objective that was not measured."""

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        self.name, self.known = name, known
        close = closest_name(name, known)
        meant = f"; did you mean {close!r}?" if close else "."
        super().__init__(
            f"no objective {str(name)[:80]!r} was measured{meant} Measured: "
            f"{', '.join(known) or 'none'}"
        )

    def __reduce__(self) -> tuple[type[UnknownObjective], tuple[str, tuple[str, ...]]]:
        return type(self), (self.name, self.known)


class CampaignError(DrivoraError):
    """A campaign cannot be started, resumed or compared."""


class StoreError(DrivoraError):
    """The database or a trace file cannot be used."""


class StoreUnavailable(StoreError):
    """The database cannot be used at the moment: it is locked, or its disk is full or missing.

    The request has not been done and may be repeated unchanged.
    """


class StoreDamaged(StoreUnavailable):
    """The database is damaged: nothing is stored before it is restored.

    No run and no campaign is to blame, and the request may be repeated after that.
    """


class TraceDamaged(StoreError):
    """The trace file of a run is not the one that was recorded, cannot be read, or is missing.

    Attributes:
        code: Short stable name: ``trace_differs``, ``trace_unreadable``, ``trace_missing``.
        file: Path of the file.
    """

    def __init__(self, message: str, *, code: str = "trace_differs", file: str = "") -> None:
        self.code, self.file = code, file
        super().__init__(message)


class Conflict(StoreError):
    """The request conflicts with the stored state."""


class NothingStored(StoreError):
    """There is no database where one is to be read."""


class QueueFull(StoreError):
    """The queue has reached its limit.

    Attributes:
        queued: Number of queued runs.
        limit: Greatest number of queued runs.
        retry_after_s: Seconds after which to repeat the request.
    """

    def __init__(self, *, queued: int, limit: int, retry_after_s: int) -> None:
        self.queued, self.limit, self.retry_after_s = queued, limit, retry_after_s
        super().__init__(
            f"{queued} runs wait and the queue holds {limit}; try again in {retry_after_s} s, "
            "or raise DRIVORA_QUEUE_LIMIT"
        )


class AddressTaken(DrivoraError):
    """Another process has the address that a server is to listen on."""


class ServiceBroken(DrivoraError):
    """A part of this service fails repeatedly: the process ends and must be restarted."""


class ServiceError(DrivoraError):
    """A service refused an HTTP request, or did not answer.

    Attributes:
        status: HTTP status of the answer; 0 if there was none.
    """

    def __init__(self, message: str, *, status: int = 0) -> None:
        self.status = status
        super().__init__(message)


class NotAuthorised(ServiceError):
    """The service needs an API token, or one with another scope."""


class NotFound(ServiceError):
    """The requested object does not exist on the service."""


class RequestConflict(ServiceError):
    """The request conflicts with the stored state of the service."""


class ServiceUnavailable(ServiceError):
    """The service did not answer, or cannot answer at the moment."""


class ConfigurationError(DrivoraError):
    """A setting cannot be used."""


class CredentialsUnusable(ConfigurationError):
    """The file of the API tokens or of the sessions cannot be read or written."""
