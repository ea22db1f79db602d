"""The packages' policies, loaded with their weights.

Each answers an observation with the pose for a tenth of a second later.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from importlib.resources import as_file, files
from types import ModuleType
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from drivora_service.agents.adapters.smarts_agents.scene import Scene
from drivora_service.geometry.array_shapes import FloatArray


class Policy(Protocol):
    """A policy during one run."""

    def act(self, obs: Scene) -> Any:
        """Returns x, y, heading and the seconds until then."""
        ...


def load_iamp() -> Callable[[], Policy]:
    """Loads the predictor of interaction and the planner that uses it."""
    _stand_in_for_drawing()
    policy: Policy = import_module("interaction_aware_motion_prediction.policy").Policy()
    # It is reset at the first step of a run.
    return lambda: policy


def load_dsac() -> Callable[[], Policy]:
    """Loads the actor, the classifier of tasks and the predictor of collisions."""
    policy: Policy = import_module("discrete_soft_actor_critic.policy").Policy()
    return lambda: policy


def load_casl() -> Callable[[], Policy]:
    """Loads the imitated choice between driving and standing, and the rules around it."""
    package = "control_and_supervised_learning"
    rules = import_module(f"{package}.eval").EnvWrapper
    with as_file(files(package) / "model_20000.pt") as path:
        weights = torch.load(path, map_location="cpu", weights_only=True)["_imitator"]
    network = StandOrDrive(weights)
    return lambda: _Casl(rules(model=network))


LOADERS: dict[str, Callable[[], Callable[[], Policy]]] = {
    "iamp": load_iamp,
    "dsac": load_dsac,
    "casl": load_casl,
}
"""Loaders by the name of the policy, each of which returns a factory for runs."""


class StandOrDrive:
    """The network of CASL: three layers of 750, and a choice between standing (0) and driving (1).

    Replaces the library that trained it, of which no other part is needed.
    """

    def __init__(self, weights: dict[str, torch.Tensor]) -> None:
        """Args: weights: Weights as saved by the library."""
        self._hidden = [
            (weights[f"_encoder._fcs.{k}.weight"], weights[f"_encoder._fcs.{k}.bias"])
            for k in range(3)
        ]
        self._last = weights["_fc.weight"], weights["_fc.bias"]

    def logits(self, observations: FloatArray) -> FloatArray:
        """Returns the (n, 2) logits for (n, 53) observations."""
        with torch.no_grad():
            values = torch.as_tensor(observations, dtype=torch.float32)
            for weight, bias in self._hidden:
                values = torch.relu(torch.nn.functional.linear(values, weight, bias))
            answer: FloatArray = torch.nn.functional.linear(values, *self._last).numpy()
        return answer

    def predict(self, observations: list[FloatArray]) -> NDArray[np.int64]:
        """Returns the likeliest choice for each observation; named as in the library."""
        choices: NDArray[np.int64] = self.logits(np.stack(observations)).argmax(axis=1)
        return choices


class _Casl:
    """CASL's rules, which are called differently for the first observation."""

    def __init__(self, rules: Any) -> None:
        self._rules = rules
        self._begun = False

    def act(self, obs: Scene) -> Any:
        tell = self._rules.step if self._begun else self._rules.reset
        self._begun = True
        tell(obs)
        return self._rules.rule_based_action()


def _stand_in_for_drawing() -> None:
    """Allows importing the package without Matplotlib, which only its pictures need."""
    if "matplotlib" not in sys.modules:
        library, drawing = ModuleType("matplotlib"), ModuleType("matplotlib.pyplot")
        library.pyplot = drawing  # type: ignore[attr-defined] # as an import of it would
        sys.modules.update({"matplotlib": library, "matplotlib.pyplot": drawing})
