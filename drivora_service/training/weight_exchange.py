"""Conversion of weights between PyTorch's modules and the agents' dataclasses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np
import torch
from torch import Tensor

from drivora_service.geometry.array_shapes import Float32Array

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Parts: TypeAlias = "Tensor | Sequence[Parts]"
"""One parameter of a module, or several that are stacked to one array."""

W = TypeVar("W", bound="DataclassInstance")


def weights_of(type_: type[W], parts: Mapping[str, Parts]) -> W:
    """Returns copies of parameters as a network's dataclass, matrices with the inputs first.

    Args:
        type_: The dataclass.
        parts: Parameters by the names of its fields.
    """
    return type_(**{name: _array(part) for name, part in parts.items()})


def put_weights(weights: DataclassInstance, parts: Mapping[str, Parts]) -> None:
    """Writes a dataclass's arrays into parameters; the inverse of ``weights_of``."""
    with torch.no_grad():
        for name, part in parts.items():
            _put(getattr(weights, name), part)


def _array(part: Parts) -> Float32Array:
    if isinstance(part, Sequence):
        return np.stack([_array(one) for one in part])
    array: Float32Array = part.detach().numpy().T.astype(np.float32, order="C")
    return array


def _put(array: Float32Array, part: Parts) -> None:
    if isinstance(part, Sequence):
        for one, values in zip(part, array, strict=True):
            _put(values, one)
        return
    part.copy_(torch.from_numpy(np.ascontiguousarray(array.T)))
