"""The reference names every oracle with its thresholds as they are."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import Oracle, Outcome
from drivora_service.testing.networks import straight_road
from drivora_service.testing.oracle_contract import example_runs


@pytest.fixture(scope="module")
def reference(repository: Path) -> dict[str, str]:
    """The text under each heading of the third level."""
    text = (repository / "docs" / "reference" / "oracles.md").read_text(encoding="utf-8")
    pieces = re.split(r"^### `(\w+)`$", text.split("## Metrics")[0], flags=re.MULTILINE)[1:]
    return dict(zip(pieces[::2], pieces[1::2], strict=True))


def test_every_oracle_has_its_section(reference: dict[str, str]) -> None:
    assert set(reference) == {oracle.name for oracle in default_oracles()}


@pytest.mark.parametrize("oracle", default_oracles(), ids=lambda oracle: oracle.name)
def test_every_threshold_stands_there_with_its_default(
    oracle: Oracle, reference: dict[str, str]
) -> None:
    rows = re.findall(r"^\| `(\w+)` \| (-?[\d.]+) \|", reference[oracle.name], re.MULTILINE)
    written = {name: float(value) for name, value in rows}
    real = {field.name: getattr(oracle, field.name) for field in fields(oracle)}  # type: ignore[arg-type]  # oracles are dataclasses
    assert written == pytest.approx(real, abs=1e-3)


def test_severities_stand_there_as_they_are(repository: Path) -> None:
    text = (repository / "docs" / "reference" / "oracles.md").read_text(encoding="utf-8")
    written = {
        name: severity
        for names, severity in re.findall(
            r"^\| ((?:`\w+`(?:, )?)+) \| `(\w+)` \|", text, re.MULTILINE
        )
        for name in re.findall(r"`(\w+)`", names)
    }
    assert set(written) >= {oracle.name for oracle in default_oracles()}
    broken = [
        verdict
        for trace in example_runs()
        for verdict in judge_all(trace, straight_road(), default_oracles())
        if verdict.outcome is Outcome.VIOLATED
    ]
    assert {verdict.oracle for verdict in broken} >= {"speeding", "blocked", "near_miss"}
    assert {verdict.oracle: str(verdict.severity) for verdict in broken}.items() <= written.items()
