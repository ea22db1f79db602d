"""Reading and writing of the shipped weights."""

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
    """Reads the weights beside the module of a network, once in each process.

    Args:
        type_: A dataclass whose fields are the names of the file's arrays.
    """
    package = type_.__module__.rpartition(".")[0]
    with resources.files(package).joinpath(FILE_NAME).open("rb") as file, np.load(file) as arrays:
        return type_(**{field.name: arrays[field.name] for field in fields(type_)})


def save_weights(weights: DataclassInstance, path: Path) -> None:
    """Writes weights for :func:`load_weights`, to a file of exactly this name."""
    # Given a name instead of a file, NumPy would append its own suffix.
    with path.open("wb") as file:
        np.savez(file, **{field.name: getattr(weights, field.name) for field in fields(weights)})
