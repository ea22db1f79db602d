"""The seeds of a suite's runs."""

from __future__ import annotations

import zlib

from drivora_service.scenario.fields import MAX_SEED

_SPREAD = 1_000_000
"""Seeds over which the scenarios of a suite are spread."""


def seed_of_run(scenario: str, own: int, repetition: int, *, given: int | None) -> int:
    """Returns the seed of a run.

    The first repetition has the scenario's own seed. All others have seeds that differ between the
    scenarios: under one seed, an ADS may draw the same numbers in all of them, and its failures in
    different scenarios would not be independent, as statistics assume.

    Args:
        scenario: Name of the scenario.
        own: Seed in its document.
        repetition: From 0.
        given: Number from which the seeds follow, in place of the scenarios' own.
    """
    if given is None and repetition == 0:
        return own
    first = own if given is None else given
    # Seeds beyond the greatest one begin at 0 again.
    return (first + zlib.crc32(scenario.encode()) % _SPREAD + repetition) % (MAX_SEED + 1)
