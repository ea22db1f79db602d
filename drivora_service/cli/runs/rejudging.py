"""Recorded traces judged by the current oracles, compared with their earlier verdicts."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from drivora_service.errors import ConfigurationError, DrivoraError, NetworkError, TraceDamaged
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.checked_trace import read_checked_trace
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.oracles_version import judged_by_current
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.verdict_changes import (
    NOT_INSTALLED,
    VerdictChange,
    verdict_changes,
)
from drivora_service.oracles.verdicts.verdict_json import verdict_content

TRACE = ".trace.parquet"
"""How the names of the traces end that commands write."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejudged:
    """A trace judged by the current oracles.

    Attributes:
        name: Its run, for people.
        trace: Its file, or the id of its run if it came from a store or a service.
        run_id: Id of its run; "" if that is not known.
        error: Why it could not be judged, or "".
        is_damaged: Whether that is because its file is not what was recorded.
        note: Why it was not compared though nothing failed, or "".
        by_other_oracles: Whether its earlier verdicts were given by another version of the
            oracles, or by a version that did not record its own.
        compared: Whether there are earlier verdicts to compare with.
        verdicts: By the current oracles.
        changes: Empty if nothing changed or was compared.
    """

    name: str
    trace: str
    run_id: str = ""
    error: str = ""
    is_damaged: bool = False
    note: str = ""
    by_other_oracles: bool = False
    compared: bool = False
    verdicts: tuple[Verdict, ...] = ()
    changes: tuple[VerdictChange, ...] = ()

    @property
    def is_changed(self) -> bool:
        """Whether an oracle that is installed judges otherwise than before."""
        return any(one.after != NOT_INSTALLED for one in self.changes)

    @property
    def not_installed(self) -> frozenset[str]:
        """The oracles of the earlier verdicts that are not installed."""
        return frozenset(one.oracle for one in self.changes if one.after == NOT_INSTALLED)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Report:
    """The report beside a trace.

    Attributes:
        run_id: Id of the run, or "".
        trace_sha256: Hash of its trace, or "".
        verdicts: Its verdicts; ``None`` unless the run finished.
        by_other_oracles: As of ``Rejudged``.
    """

    run_id: str = ""
    trace_sha256: str = ""
    verdicts: list[dict[str, Any]] | None = None
    by_other_oracles: bool = False


class Rejudge:
    """Judges traces by the current oracles."""

    def __init__(self, networks: NetworkCatalogue, oracles: OracleCatalogue) -> None:
        """Takes the road networks that traces may be of, and the oracles that judge."""
        self._networks, self._oracles = networks, oracles

    def file(self, path: Path) -> Rejudged:
        """Judges a trace file, and compares with the report ``NAME.report.json`` beside it."""
        report = _read_report(path)

        def read() -> Trace:
            if not report.trace_sha256:
                return read_trace(path)
            name = report.run_id or path.name.removesuffix(TRACE)
            return read_checked_trace(
                StoredTrace(run_id=name, path=path, sha256=report.trace_sha256)
            )

        note = "judged; there is no report beside it to compare with"
        named = Rejudged(
            name=path.name.partition(".")[0],
            trace=str(path),
            run_id=report.run_id,
            by_other_oracles=report.by_other_oracles,
        )
        return self.judge(named, read, report.verdicts, note=note)

    def judge(
        self,
        named: Rejudged,
        read: Callable[[], Trace],
        before: list[dict[str, Any]] | None,
        *,
        note: str,
    ) -> Rejudged:
        """Judges a trace, and compares with earlier verdicts.

        Args:
            named: Name and place of the trace, and what is known of the earlier verdicts.
            read: Reads it.
            before: Earlier verdicts; ``None``: there are none.
            note: Said if there are none.
        """
        try:
            verdicts = self._verdicts_of(read())
        except TraceDamaged as error:
            return replace(named, error=str(error), is_damaged=True)
        except (DrivoraError, OSError) as error:
            return replace(named, error=str(error))
        if before is None:
            return replace(named, verdicts=verdicts, note=note)
        after = [verdict_content(verdict) for verdict in verdicts]
        return replace(
            named,
            compared=True,
            verdicts=verdicts,
            changes=verdict_changes(before, after, installed=self._oracles.names()),
        )

    def _verdicts_of(self, trace: Trace) -> tuple[Verdict, ...]:
        network = self._networks.get(trace.network)
        if network.sha256 != trace.network_sha256:
            raise NetworkError(
                f"it was recorded on another version of the road network {trace.network!r}: judge "
                "it with the version of Drivora that recorded it"
            )
        return judge_all(trace, network, self._oracles.oracles())


def find_traces(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Returns the trace files that are named, and those inside folders, in order of name.

    Raises:
        ConfigurationError: A folder holds no trace.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        inside = sorted(path.rglob(f"*{TRACE}"))
        if not inside:
            raise ConfigurationError(
                f"{path} holds no trace (*{TRACE}), and is no data folder of Drivora nor within one"
            )
        found += inside
    return tuple(dict.fromkeys(found))


def _read_report(trace: Path) -> _Report:
    """Returns the report beside a trace; an empty one if there is none that can be used."""
    path = trace.with_name(trace.name.removesuffix(TRACE) + ".report.json")
    try:
        content = json.loads(path.read_bytes())
        is_finished = content["status"] == "finished"
        return _Report(
            run_id=str(content.get("id") or ""),
            trace_sha256=str(content.get("trace_sha256") or ""),
            verdicts=list(content["verdicts"]) if is_finished else None,
            by_other_oracles=is_finished and not judged_by_current(content.get("versions") or {}),
        )
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return _Report()
