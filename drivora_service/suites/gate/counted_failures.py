"""Which violations are failures, by accountability."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from drivora_service.oracles.verdicts.accountability import ACCOUNTABLE, AT_FAULT, Accountability


class Counted(StrEnum):
    """The violations that are failures."""

    ACCOUNTABLE = "accountable"
    """An ego is accountable: avoidable, not measurable whether, or fault is not attributed."""
    AT_FAULT = "at_fault"
    """As `accountable`, and also those that were not avoidable."""
    ANY = "any"
    """Also those that are the fault of others, or undetermined."""


COUNTED: Mapping[Counted, frozenset[Accountability]] = {
    Counted.ACCOUNTABLE: ACCOUNTABLE,
    Counted.AT_FAULT: ACCOUNTABLE | AT_FAULT,
    Counted.ANY: frozenset(Accountability),
}
