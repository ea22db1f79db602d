"""The testing methods of the benchmarks, and which of them this installation can run."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.search.testers.deepcollision.tester import missing_modules

METHODS = (
    "random",
    "avfuzzer",
    "behavexplor",
    "doppeltest",
    "samota",
    "lawbreaker",
    "drivefuzz",
    "decictor",
    "deepcollision",
)
"""Names of all testers that are built in."""


def installed_methods(wanted: Sequence[str] = METHODS) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns the methods that can be run, and a sentence for each that cannot."""
    missing = missing_modules()
    if not missing or "deepcollision" not in wanted:
        return tuple(wanted), ()
    left_out = (
        f"deepcollision: {', '.join(missing)} not installed; they are the extra 'adversary' "
        "(pip install '.[adversary]')"
    )
    return tuple(name for name in wanted if name != "deepcollision"), (left_out,)
