"""The source and the reading of the expert's weights."""

from __future__ import annotations

import zipfile
from functools import lru_cache
from pathlib import Path

import numpy as np

from drivora_service.agents.metadrive_ppo.policy import HIDDEN, OBSERVATION_SIZE, ExpertWeights
from drivora_service.agents.package_files import PackageFile
from drivora_service.errors import AgentError

FILE_NAME = "weights.npz"

WEIGHTS_FILE = PackageFile(
    package="metadrive-simulator",
    version="0.4.3",
    file="metadrive_simulator-0.4.3-py3-none-any.whl",
    sha256="c6f8a42baac939a0af53a8e1cd9d48ec2bf0051917e7c19083e156a6506493d9",
    members={"metadrive/examples/ppo_expert/expert_weights.npz": FILE_NAME},
)

_SCOPE = "default_policy"


@lru_cache(maxsize=4)
def load_weights(folder: Path) -> ExpertWeights:
    """Reads the weights from an agent's folder, once in each process.

    Raises:
        AgentError: If they are missing, or not the expert's.
    """
    path = folder / FILE_NAME
    shapes = {
        "fc_1/kernel": (OBSERVATION_SIZE, HIDDEN),
        "fc_1/bias": (HIDDEN,),
        "fc_2/kernel": (HIDDEN, HIDDEN),
        "fc_2/bias": (HIDDEN,),
        "fc_out/kernel": (HIDDEN, 4),
        "fc_out/bias": (4,),
    }
    try:
        with np.load(path) as archive:
            layers = {name: archive[f"{_SCOPE}/{name}"].astype(np.float32) for name in shapes}
    except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise _unusable(f"{type(error).__name__}: {error}") from error
    for name, shape in shapes.items():
        if layers[name].shape != shape:
            raise _unusable(f"{name} has the shape {layers[name].shape}, not {shape}")
    return ExpertWeights(
        first=layers["fc_1/kernel"],
        first_bias=layers["fc_1/bias"],
        second=layers["fc_2/kernel"],
        second_bias=layers["fc_2/bias"],
        out=np.ascontiguousarray(layers["fc_out/kernel"][:, :2]),
        out_bias=layers["fc_out/bias"][:2],
    )


def _unusable(why: str) -> AgentError:
    return AgentError(
        f"agent 'metadrive-ppo': {FILE_NAME} cannot be used ({why}); fetch it again with "
        "`drivora agents install metadrive-ppo --again`",
        cause="agent_install",
    )
