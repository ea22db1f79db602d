from __future__ import annotations

import pytest

from drivora_service.oracles.laws.units import ACCELERATION, METRE, ONE, SECOND, SPEED, read_unit


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("m", METRE),
        ("s", SECOND),
        ("1", ONE),
        ("m/s", SPEED),
        ("m/s²", ACCELERATION),
        ("m/s^2", ACCELERATION),
        ("m / s / s", ACCELERATION),
        ("m·s", METRE * SECOND),
        ("1/s", ONE / SECOND),
    ],
)
def test_units_are_read(text: str, unit: object) -> None:
    assert read_unit(text) == unit


@pytest.mark.parametrize("text", ["km/h", "", "m/", "ms", "m^", "m^22", "°"])
def test_other_units_are_not(text: str) -> None:
    assert read_unit(text) is None


@pytest.mark.parametrize("unit", [METRE, SPEED, ACCELERATION, ONE, ONE / SECOND, METRE * METRE])
def test_a_unit_reads_as_it_is_written(unit: object) -> None:
    assert read_unit(str(unit)) == unit
