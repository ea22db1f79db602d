"""Reading a gate: the document and all its names, validated together."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any, Literal

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.structure import read_structure
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.named_parts import (
    is_metric,
    items_of,
    unknown,
    unknown_oracles,
)


def read_gate_document(
    data: str | bytes | Mapping[str, Any],
    *,
    oracles: Collection[str],
    metrics: Collection[str],
    format: Literal["json", "yaml"] = "yaml",  # noqa: A002  # reads best in calls
) -> GateDocument:
    """Reads a gate.

    Args:
        data: Text, or its parsed content.
        oracles: Names of the oracles that runs are judged by.
        metrics: Names of the metrics that describe runs.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The document has problems; all are listed, in document order.
    """

    def find_unknown_names(content: Mapping[str, Any]) -> Iterator[Problem]:
        return _unknown_names(content, oracles, metrics)

    document, content, odd = read_structure(
        data, GateDocument, format, what="a gate", further=find_unknown_names
    )
    problems = [*odd, *find_unknown_names(content)]
    if problems:
        raise InvalidDocument(in_document_order(problems, content))
    return document


def _unknown_names(
    content: Mapping[str, Any], oracles: Collection[str], metrics: Collection[str]
) -> Iterator[Problem]:
    yield from unknown_oracles(content, oracles)
    for index, limit in items_of(content, "limits"):
        yield from unknown_oracles(limit, oracles, f"/limits/{index}")
    for index, one in items_of(content, "metrics"):
        name = one.get("metric") if isinstance(one, Mapping) else None
        if isinstance(name, str) and not is_metric(name, metrics):
            yield unknown("metric", name, metrics, f"/metrics/{index}/metric")
