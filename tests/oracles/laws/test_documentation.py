"""The reference has every signal and every shipped law as they are."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from drivora_service.oracles.laws.law_signals import SIGNALS
from drivora_service.oracles.laws.signal_records import Signal
from tests.oracles.laws.laws import library

REFERENCE = (Path(__file__).parents[3] / "docs/reference/laws.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("signal", SIGNALS, ids=lambda signal: signal.name)
def test_every_signal_is_in_the_reference(signal: Signal) -> None:
    unit = "flag" if signal.is_flag else str(signal.unit)
    scale = "" if signal.is_flag else f"{signal.scale:g}"
    absent = "" if signal.is_flag or math.isnan(signal.absent) else f"{signal.absent:g}"
    assert f"| `{signal.name}` | {unit} | {scale} | {absent} | {signal.meaning} |\n" in REFERENCE


@pytest.mark.parametrize("name", library().names())
def test_every_shipped_law_is_in_the_reference(name: str) -> None:
    law = library().law(name)
    section = REFERENCE.partition(f"### `{name}`\n")[2].partition("\n### ")[0]
    assert section.startswith(f"{law.title}. {law.description} {law.source}.\n")
    assert f"```\n{law.text}\n```" in section
    for one in law.parameters:
        assert f"| `{one.name}` | {one.value:g} | {one.unit} | {one.meaning} |\n" in section
    assert (f"Left out: {law.left_out}\n" in section) == bool(law.left_out)


def test_no_signal_or_law_is_in_the_reference_only() -> None:
    table = REFERENCE.partition("## Signals\n")[2].partition("\n## ")[0]
    rows = [line.split("`")[1] for line in table.splitlines() if line.startswith("| `")]
    assert rows == [signal.name for signal in SIGNALS]
    assert [
        line.split("`")[1] for line in REFERENCE.splitlines() if line.startswith("### `")
    ] == list(library().names())
