"""Stored traces judged by the current oracles, compared with their earlier verdicts."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drivora_service.errors import ConfigurationError, DrivoraError, NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.verdict_changes import VerdictChange, verdict_changes
from drivora_service.oracles.verdicts.verdict_json import verdict_content

_TRACE = ".trace.parquet"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejudged:
    """A trace judged by the current oracles.

    Attributes:
        error: Why it could not be judged, or "".
        compared: Whether there is a report beside it to compare with.
        verdicts: By the current oracles.
        changes: Empty if nothing changed or was compared.
    """

    trace: Path
    error: str = ""
    compared: bool = False
    verdicts: tuple[Verdict, ...] = ()
    changes: tuple[VerdictChange, ...] = ()


def find_traces(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Returns the trace files that are named, and those inside folders, in order of name.

    Raises:
        ConfigurationError: A path does not exist, or a folder holds no trace.
    """
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            inside = sorted(path.rglob(f"*{_TRACE}"))
            if not inside:
                raise ConfigurationError(f"{path} holds no trace (*{_TRACE})")
            found += inside
        elif path.is_file():
            found.append(path)
        else:
            raise ConfigurationError(f"there is no file {path}")
    return tuple(dict.fromkeys(found))


def rejudge(path: Path, networks: NetworkCatalogue, oracles: OracleCatalogue) -> Rejudged:
    """Judges a stored trace, and compares with the report ``NAME.report.json`` beside it."""
    try:
        trace = read_trace(path)
        network = networks.get(trace.network)
        if network.sha256 != trace.network_sha256:
            raise NetworkError(
                f"it was recorded on another version of the road network {trace.network!r}: judge "
                "it with the version of Drivora that recorded it"
            )
        verdicts = judge_all(trace, network, oracles.oracles())
    except (DrivoraError, OSError) as error:
        return Rejudged(trace=path, error=str(error))
    before = _read_verdicts(path)
    if before is None:
        return Rejudged(trace=path, verdicts=verdicts)
    after = [verdict_content(verdict) for verdict in verdicts]
    return Rejudged(
        trace=path,
        compared=True,
        verdicts=verdicts,
        changes=verdict_changes(before, after),
    )


def _read_verdicts(path: Path) -> list[dict[str, Any]] | None:
    """Returns the verdicts of the report beside a trace; ``None`` without a usable report."""
    report = path.with_name(path.name.removesuffix(_TRACE) + ".report.json")
    try:
        content = json.loads(report.read_bytes())
        return list(content["verdicts"]) if content["status"] == "finished" else None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
