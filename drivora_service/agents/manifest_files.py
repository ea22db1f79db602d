"""Paths of manifests: shipped ones, and those in the operator's folder."""

from __future__ import annotations

import re
from pathlib import Path

from drivora_service.scenario.fields import NAME_PATTERN

FILE_NAME = "agent.yaml"
"""Name of an operator's manifest, in a folder named after the agent."""

_NAME = re.compile(NAME_PATTERN)
_SHIPPED = Path(__file__).resolve().parent / "adapters"


def shipped_manifests() -> dict[str, Path]:
    """Returns the manifests of the built-in agents that need an environment, by name."""
    return {path.stem: path for path in sorted(_SHIPPED.glob("*/*.yaml"))}


def operator_manifests(folder: Path | None) -> dict[str, Path]:
    """Returns the manifests in a folder of agents (``NAME/agent.yaml``), by name."""
    if folder is None or not folder.is_dir():
        return {}
    return {
        path.parent.name: path
        for path in sorted(folder.glob(f"*/{FILE_NAME}"))
        if _NAME.fullmatch(path.parent.name)
    }
