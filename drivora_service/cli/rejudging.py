"""Stored traces judged by the current oracles, compared with their earlier verdicts."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drivora_service.errors import ConfigurationError, DrivoraError, NetworkError
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.observations.trace_file import read_trace
from drivora_service.oracles.accountability import IN_WORDS, accountable
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.verdict import Answer, Verdict
from drivora_service.oracles.verdict_json import verdict_content

_TRACE = ".trace.parquet"


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """An oracle whose verdict on an ego has changed.

    Attributes:
        before: In words; ``not judged`` if there was no such oracle.
        after: In words; ``not judged`` if there is no such oracle any more.
    """

    oracle: str
    ego: str
    before: str
    after: str


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
    changes: tuple[Change, ...] = ()


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
    before = _reported(path)
    if before is None:
        return Rejudged(trace=path, verdicts=verdicts)
    after = [verdict_content(verdict) for verdict in verdicts]
    return Rejudged(
        trace=path,
        compared=True,
        verdicts=verdicts,
        changes=tuple(_changes(_in_words(before), _in_words(after))),
    )


def _reported(path: Path) -> list[dict[str, Any]] | None:
    """Returns the verdicts of the report beside a trace; ``None`` without a usable report."""
    report = path.with_name(path.name.removesuffix(_TRACE) + ".report.json")
    try:
        content = json.loads(report.read_bytes())
        return list(content["verdicts"]) if content["status"] == "finished" else None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _in_words(verdicts: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str], str]:
    """Returns the verdicts of each oracle on each ego in words, several violations counted."""
    said: dict[tuple[str, str], Counter[str]] = {}
    for verdict in verdicts:
        key = (str(verdict["oracle"]), str(verdict["ego"]))
        said.setdefault(key, Counter())[_words(verdict)] += 1
    return {
        key: ", ".join(
            words if count == 1 else f"{count} times {words}"
            for words, count in sorted(counted.items())
        )
        for key, counted in said.items()
    }


def _words(verdict: Mapping[str, Any]) -> str:
    outcome = str(verdict["outcome"])
    text = outcome.replace("_", " ")
    if outcome != "violated":
        return text
    avoidable = verdict.get("avoidable")
    words = IN_WORDS[
        accountable(
            verdict.get("at_fault"),
            None if avoidable is None else Answer(avoidable),
            undetermined=bool(verdict.get("undetermined")),
        )
    ]
    return f"{text} ({words})" if words else text


def _changes(
    before: Mapping[tuple[str, str], str], after: Mapping[tuple[str, str], str]
) -> Iterable[Change]:
    for oracle, ego in dict.fromkeys((*after, *before)):
        old, new = (said.get((oracle, ego), "not judged") for said in (before, after))
        if old != new:
            yield Change(oracle=oracle, ego=ego, before=old, after=new)
