"""The source and the reading of the policy's weights."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.puffer_drive.policy import (
    ACCELERATIONS,
    EGO_SIZE,
    FEATURES,
    HIDDEN,
    ROAD_KINDS,
    ROAD_SIZE,
    STEERINGS,
    VEHICLE_SIZE,
    DriveWeights,
)
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import Float32Array

FILE_NAME = "weights.bin"

WEIGHTS_FILE = PackageFile(
    package="pufferlib",
    version="3.0.0",
    file="pufferlib-3.0.0.tar.gz",
    sha256="7df3a3e3f5f894d78d2a1f5374097890aec01473183e748abefe4f3faa10eaa9",
    members={"pufferlib-3.0.0/pufferlib/resources/gpudrive/gpudrive_weights.bin": FILE_NAME},
)

_ACTIONS = ACCELERATIONS + STEERINGS
_SHAPES: tuple[tuple[str, tuple[int, ...]], ...] = (
    ("ego", (FEATURES, EGO_SIZE)),
    ("ego_bias", (FEATURES,)),
    ("road", (FEATURES, ROAD_SIZE - 1 + ROAD_KINDS)),
    ("road_bias", (FEATURES,)),
    ("vehicle", (FEATURES, VEHICLE_SIZE)),
    ("vehicle_bias", (FEATURES,)),
    ("shared", (HIDDEN, 3 * FEATURES)),
    ("shared_bias", (HIDDEN,)),
    ("actor", (_ACTIONS, HIDDEN)),
    ("actor_bias", (_ACTIONS,)),
    ("value", (1, HIDDEN)),
    ("value_bias", (1,)),
    ("lstm_input", (4 * HIDDEN, HIDDEN)),
    ("lstm_hidden", (4 * HIDDEN, HIDDEN)),
    ("lstm_input_bias", (4 * HIDDEN,)),
    ("lstm_hidden_bias", (4 * HIDDEN,)),
)
"""The concatenated parameters as 32-bit floats, outputs first: PufferLib's order."""


@lru_cache(maxsize=4)
def load_weights(folder: Path) -> DriveWeights:
    """Reads the weights from an agent's folder, once in each process.

    Raises:
        AgentError: If they are missing, or not the policy's.
    """
    path = folder / FILE_NAME
    wanted = sum(int(np.prod(shape)) for _, shape in _SHAPES)
    try:
        numbers = np.fromfile(path, dtype="<f4")
    except OSError as error:
        raise _unusable(f"{type(error).__name__}: {error}") from error
    if len(numbers) != wanted or not np.isfinite(numbers).all():
        raise _unusable(f"it holds {len(numbers)} numbers; wanted are {wanted} finite ones")
    parts: dict[str, Float32Array] = {}
    at = 0
    for name, shape in _SHAPES:
        size = int(np.prod(shape))
        parts[name] = np.ascontiguousarray(numbers[at : at + size].reshape(shape).T)
        at += size
    return DriveWeights(
        ego=parts["ego"],
        ego_bias=parts["ego_bias"],
        road=parts["road"][: ROAD_SIZE - 1].copy(),
        road_kinds=parts["road"][ROAD_SIZE - 1 :] + parts["road_bias"],
        vehicle=parts["vehicle"],
        vehicle_bias=parts["vehicle_bias"],
        shared=parts["shared"],
        shared_bias=parts["shared_bias"],
        lstm=np.concatenate((parts["lstm_input"], parts["lstm_hidden"])),
        lstm_bias=parts["lstm_input_bias"] + parts["lstm_hidden_bias"],
        actor=parts["actor"],
        actor_bias=parts["actor_bias"],
    )


def _unusable(why: str) -> AgentError:
    return AgentError(
        f"agent 'puffer-drive': {FILE_NAME} cannot be used ({why}); fetch it again with "
        "`drivora agents install puffer-drive --again`",
        cause="agent_install",
    )
