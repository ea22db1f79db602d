"""An adversary that acts during a run, as values: its actions, its policy, and what came of them.

The adversary decides every few seconds, by the greatest value that a network assigns to an action
in the present situation, or by lot. The network is an MLP with rectified linear units; its layers
travel in text, so that a worker needs no library for learning.
"""

from __future__ import annotations

import base64
import binascii
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray

OBSERVATION_SIZE = 39
"""Number of values that describe a situation to a policy, each within -1..1."""

OBSERVATIONS = "observations"
"""Table of a measurement: the situation before each decision, and after the last one."""
DECISIONS = "decisions"
"""Table of a measurement: action, reward, and 1 if the ego's part ended, of each decision."""

EXTENSION = "drivora:interventions"
"""Key of a scenario's extensions with what the adversary did."""


class Action(StrEnum):
    """An action of the adversary; their order is that of the outputs of a policy."""

    NOTHING = "nothing"
    VEHICLE_BRAKES = "vehicle-brakes"
    """A vehicle ahead on the ego's lane brakes nearly to a standstill."""
    VEHICLE_SLOW = "vehicle-slow"
    """A slow vehicle ahead on the ego's lane."""
    VEHICLE_STANDS = "vehicle-stands"
    """A vehicle ahead on the ego's lane hardly moves for 20 s."""
    VEHICLE_CUTS_IN_LEFT = "vehicle-cuts-in-left"
    """A vehicle changes from the lane to the left to just ahead of the ego, and slows down."""
    VEHICLE_CUTS_IN_RIGHT = "vehicle-cuts-in-right"
    """The same from the right."""
    VEHICLE_FOLLOWS = "vehicle-follows"
    """A vehicle closes up behind the ego."""
    VEHICLE_CROSSES = "vehicle-crosses"
    """A vehicle crosses the ego's route at the next place where lanes cross it."""
    WALKER_RIGHT = "walker-right"
    """A pedestrian crosses ahead of the ego from the right."""
    WALKER_LEFT = "walker-left"
    """The same from the left."""
    RUNNER_RIGHT = "runner-right"
    """A pedestrian runs onto the road from the right, nearer to the ego."""
    RUNNER_LEFT = "runner-left"
    """The same from the left."""
    CLEAR_SKY = "clear-sky"
    """No rain, no fog, a dry road."""
    LIGHT_RAIN = "light-rain"
    HEAVY_RAIN = "heavy-rain"
    FOG = "fog"
    NOON = "noon"
    DUSK = "dusk"
    NIGHT = "night"


ACTIONS = tuple(Action)


@dataclass(frozen=True, slots=True, kw_only=True)
class AdversarySource:
    """An adversary for one run.

    Attributes:
        policy: Layers of its network as :func:`layers_to_text` writes them; "" for none, which is
            allowed if every decision is by lot.
        exploration: Probability with which a decision is by lot.
        seed: Seeds its draws.
        interval: Seconds of simulation between two decisions.
    """

    policy: str
    exploration: float
    seed: int
    interval: float


Layer = tuple[FloatArray, FloatArray]
"""(outputs, inputs) weights and (outputs,) biases."""


def layers_to_text(layers: Sequence[Layer]) -> str:
    """Writes the layers of a network, in single precision."""
    values = [np.asarray(part, dtype="<f4") for layer in layers for part in layer]
    sizes = np.array([layers[0][0].shape[1], *(len(bias) for _, bias in layers)], dtype="<u4")
    body = b"".join(
        part.tobytes() for part in (np.array([len(sizes)], dtype="<u4"), sizes, *values)
    )
    return base64.b64encode(body).decode()


def layers_from_text(text: str) -> tuple[Layer, ...]:
    """Reads what :func:`layers_to_text` wrote.

    Raises:
        SearchError: The text is no network from observations to actions.
    """
    try:
        body = base64.b64decode(text, validate=True)
        count = int(np.frombuffer(body, dtype="<u4", count=1)[0])
        sizes = np.frombuffer(body, dtype="<u4", count=count, offset=4).tolist()
        values = np.frombuffer(body, dtype="<f4", offset=4 + 4 * count).astype(np.float64)
    except (binascii.Error, ValueError, IndexError) as error:
        raise SearchError(f"the policy of an adversary cannot be read: {error}") from error
    needed = sum((before + 1) * after for before, after in itertools.pairwise(sizes))
    if (
        len(sizes) < 2
        or (sizes[0], sizes[-1]) != (OBSERVATION_SIZE, len(ACTIONS))
        or len(values) != needed
        or not np.isfinite(values).all()
    ):
        raise SearchError(
            f"the policy of an adversary is a network of {sizes} with {len(values)} values; needed "
            f"is one from {OBSERVATION_SIZE} inputs to {len(ACTIONS)} outputs with {needed} finite "
            "values"
        )
    layers: list[Layer] = []
    place = 0
    for before, after in itertools.pairwise(sizes):
        weights = values[place : place + before * after].reshape(after, before)
        place += before * after
        layers.append((weights, values[place : place + after]))
        place += after
    return tuple(layers)


def action_values(layers: Sequence[Layer], observation: FloatArray) -> FloatArray:
    """Returns the (n,) values that a network assigns to the actions in a situation."""
    hidden = np.asarray(observation, dtype=np.float64)
    for number, (weights, bias) in enumerate(layers):
        # A sum of products, whose order does not depend on the processor's matrix kernels.
        hidden = np.einsum("ij,j->i", weights, hidden) + bias
        if number < len(layers) - 1:
            hidden = np.maximum(hidden, 0.0)
    return hidden
