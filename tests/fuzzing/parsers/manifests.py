"""Manifests of ADSs: ``agent.yaml``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import yaml

from drivora_service.agents.manifest import command_line, read_manifest
from drivora_service.agents.manifest_files import shipped_manifests
from drivora_service.agents.manifest_parameters import parameters_type
from drivora_service.errors import AgentError
from drivora_service.parameters import _adapter, describe_parameters, parameter_problems
from tests.agents.test_manifest import GOOD
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.fuzzing.parsers.shared import folder


def _parse(data: bytes) -> bool:
    path = folder() / "agents" / "mine" / "agent.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    try:
        manifest = read_manifest(path, "mine")
    except AgentError as error:
        check_refusal(error)
        return False
    assert manifest.name == "mine"
    command_line(manifest, Path("python"))
    if manifest.parameters:
        type_ = parameters_type(manifest.parameters)
        describe_parameters(type_)
        parameter_problems(type_, {"speed": 1, "mode": "a"}, of="agent 'mine'")
    # Kept for ever by a process that reads a few manifests, which this one does not.
    parameters_type.cache_clear()
    _adapter.cache_clear()
    return True


def _seeds() -> Mapping[str, bytes]:
    parameters = {
        "speed": {"type": "number", "default": 1.0, "minimum": 0, "maximum": 3, "description": "d"},
        "count": {"type": "integer", "default": 2, "minimum": 1},
        "mode": {"type": "text", "default": "a", "choices": ["a", "b"]},
        "loud": {"type": "boolean", "default": False},
    }
    full = {
        **GOOD,
        "version": "1.2",
        "variables": {"MODEL": "big"},
        "settings": ["DRIVORA_MINE_KEY"],
        "deadlines": {"start": 60, "setup": 30.0, "step": 0.5},
        "environment": "mine",
        "resolved": True,
        "parameters": parameters,
    }
    away = {**{k: v for k, v in GOOD.items() if k != "command"}, "address": "unix:/run/ads.sock"}
    seeds = {"good": GOOD, "full": full, "address": away}
    shipped = {
        name: path.read_bytes().replace(f"name: {name}\n".encode(), b"name: mine\n")
        for name, path in shipped_manifests().items()
    }
    return {
        **{name: yaml.safe_dump(seed, sort_keys=False).encode() for name, seed in seeds.items()},
        **{name: text for name, text in shipped.items() if len(text) < MANIFEST.max_length},
    }


MANIFEST = Harness(
    name="manifest",
    parse=_parse,
    seeds=_seeds,
    words=("classical", "end-to-end", "{nope}", "{python}", "{folder}", "__class__", "None"),
)
HARNESSES = by_name(MANIFEST)
