"""Reading a gate: the document and all its names, validated together."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any, Literal

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.document_problems import in_document_order
from drivora_service.scenario.structure import read_structure
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.suite_reading import is_metric, unknown


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
    document, content, odd = read_structure(data, GateDocument, format, what="a gate")
    problems = [*odd, *_unknown_names(document, oracles, metrics)]
    if problems:
        raise InvalidDocument(in_document_order(problems, content))
    return document


def _unknown_names(
    gate: GateDocument, oracles: Collection[str], metrics: Collection[str]
) -> Iterator[Problem]:
    for place, name in enumerate(gate.oracles or ()):
        if name not in oracles:
            yield unknown("oracle", name, oracles, f"/oracles/{place}")
    for index, limit in enumerate(gate.limits):
        for place, name in enumerate(limit.oracles or ()):
            if name not in oracles:
                yield unknown("oracle", name, oracles, f"/limits/{index}/oracles/{place}")
    for index, metric in enumerate(gate.metrics):
        if not is_metric(metric.metric, metrics):
            yield unknown("metric", metric.metric, metrics, f"/metrics/{index}/metric")
