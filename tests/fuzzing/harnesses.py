"""All harnesses by name, each loaded when it is needed: a session instruments what it imports."""

from __future__ import annotations

import importlib
from collections.abc import Mapping

from tests.fuzzing.harness import Harness

MODULES: Mapping[str, str] = {
    "scenario-json": "scenarios",
    "scenario-yaml": "scenarios",
    "batch-line": "scenarios",
    "original-tool": "scenario_imports",
    "leaderboard": "scenario_imports",
    "network": "networks",
    "campaign-body": "campaigns",
    "campaign-file": "campaigns",
    "manifest": "manifests",
    "trace": "traces",
    "agent-parameter": "command_line",
    "gate-oracle": "command_line",
}
"""Modules of ``tests.fuzzing.parsers``."""


def harness_named(name: str) -> Harness:
    """Returns a harness.

    Raises:
        KeyError: There is none of that name.
    """
    module = importlib.import_module(f"tests.fuzzing.parsers.{MODULES[name]}")
    found: Mapping[str, Harness] = module.HARNESSES
    return found[name]
