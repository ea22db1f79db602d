"""Reading the weights that Drivora ships, and writing them."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

W = TypeVar("W", bound="DataclassInstance")

FILE_NAME = "weights.npz"


@lru_cache(maxsize=8)
def load_weights(type_: type[W]) -> W:
    """Reads the weights that lie beside the module of a network, once a process.

    Args:
        type_: A dataclass whose fields are the names of the file's arrays.
    """
    package = type_.__module__.rpartition(".")[0]
    with resources.files(package).joinpath(FILE_NAME).open("rb") as file, np.load(file) as arrays:
        return type_(**{field.name: arrays[field.name] for field in fields(type_)})


def save_weights(weights: DataclassInstance, path: Path) -> None:
    """Writes weights as :func:`load_weights` reads them, to a file of exactly this name."""
    # Given a name in place of a file, NumPy would put its own ending behind it.
    with path.open("wb") as file:
        np.savez(file, **{field.name: getattr(weights, field.name) for field in fields(weights)})
