"""The alerts that are shipped speak of series that a real service exports."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import httpx
import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from drivora_service.runs.run_report import RunStatus

_OF_PROMETHEUS = {"up"}
"""Series that Prometheus makes itself."""

_SERIES = re.compile(r"\b(?:drivora_\w+|up)\b")
_MATCHER = re.compile(r'(\w+)\s*(=~|!~|=)\s*"([^"]*)"')


@pytest.fixture(scope="module")
def rules(repository: Path) -> list[dict[str, Any]]:
    document = yaml.safe_load((repository / "deploy/prometheus/drivora.rules.yaml").read_text())
    return [rule for group in document["groups"] for rule in group["rules"]]


@pytest.fixture(scope="module")
def exported(service_url: str) -> dict[str, set[frozenset[tuple[str, str]]]]:
    """The labels of every series, by name."""
    httpx.get(f"{service_url}/api/v1/jobs", timeout=60)
    text = httpx.get(f"{service_url}/metrics", timeout=60).text
    found: dict[str, set[frozenset[tuple[str, str]]]] = {}
    for family in text_string_to_metric_families(text):
        # Families without a sample as well: nothing may have failed yet.
        found.setdefault(family.name, set())
        for sample in family.samples:
            found.setdefault(sample.name, set()).add(frozenset(sample.labels.items()))
    return found


def test_every_series_of_an_alert_is_exported(
    rules: list[dict[str, Any]], exported: dict[str, set[frozenset[tuple[str, str]]]]
) -> None:
    named = {name for rule in rules for name in _SERIES.findall(rule["expr"])}
    assert len(named) >= 10
    assert named - _OF_PROMETHEUS <= exported.keys()


def test_labels_of_alerts_match_series(
    rules: list[dict[str, Any]], exported: dict[str, set[frozenset[tuple[str, str]]]]
) -> None:
    labels = {name for series in exported.values() for one in series for name, _ in one}
    labels |= {"cause", "instance", "job"}
    statuses, checks = {status.value for status in RunStatus}, _values(exported, "check")
    for rule in rules:
        for label, _, value in _MATCHER.findall(rule["expr"]):
            assert label in labels, rule["alert"]
            if label == "status":
                assert set(value.split("|")) <= statuses, rule["alert"]
            if label == "check":
                assert set(value.split("|")) <= checks, rule["alert"]


def test_every_alert_has_a_severity_a_summary_and_a_place_in_the_how_to(
    rules: list[dict[str, Any]], repository: Path
) -> None:
    page = (repository / "docs/how-to/operate-the-service.md").read_text()
    names = [rule["alert"] for rule in rules]
    assert len(set(names)) == len(names)
    for rule in rules:
        assert rule["labels"]["severity"] in ("critical", "warning")
        assert rule["annotations"]["summary"]
        assert f"`{rule['alert']}`" in page


def test_every_series_is_explained(
    exported: dict[str, set[frozenset[tuple[str, str]]]], repository: Path
) -> None:
    page = (repository / "docs/how-to/operate-the-service.md").read_text()
    base = {re.sub(r"_(bucket|sum|count|created|total)$", "", name) for name in exported}
    assert {name for name in base if f"`{name}" not in page} == set()


def _values(exported: dict[str, set[frozenset[tuple[str, str]]]], label: str) -> set[str]:
    return {
        value for series in exported.values() for one in series for name, value in one
        if name == label
    }  # fmt: skip
