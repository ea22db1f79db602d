"""Deep Q-learning by stable-baselines3, from transitions that were played elsewhere.

Its policy, replay buffer and training step are used, not its loop, which would play the episodes
itself. The results depend on the seed and the transitions only: the random numbers of the libraries
are seeded for each use and put back, and PyTorch computes in one thread.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.adversary import ACTIONS, OBSERVATION_SIZE, Layer
from drivora_service.search.testers.deepcollision.parameters import DeepcollisionParameters

_INITIAL = 2**32 - 1
"""Number of the draw of the first weights among those of the training steps."""


class Learner:
    """A Q-network and what it has learnt from.

    Attributes:
        transitions: Number of transitions that it was given.
    """

    def __init__(self, parameters: DeepcollisionParameters, seed: int) -> None:
        """Creates a network with random weights, which ``seed`` determines."""
        import gymnasium
        import torch
        from gymnasium import spaces
        from stable_baselines3 import DQN
        from stable_baselines3.common.logger import Logger

        class Spaces(gymnasium.Env[Any, Any]):  # type: ignore[misc]  # untyped where missing
            """Names the spaces of observations and actions; it is never stepped."""

            observation_space = spaces.Box(-1.0, 1.0, (OBSERVATION_SIZE,), np.float32)
            action_space = spaces.Discrete(len(ACTIONS))

        torch.set_num_threads(1)
        self._parameters, self._seed = parameters, seed
        self.transitions = 0
        self._steps = 0
        with self._seed_libraries(_INITIAL):
            self._model = DQN(
                "MlpPolicy",
                Spaces(),
                learning_rate=parameters.learning_rate,
                buffer_size=parameters.replay,
                batch_size=parameters.batch,
                gamma=parameters.discount,
                policy_kwargs={"net_arch": [parameters.hidden, parameters.hidden]},
                device="cpu",
            )
        self._model.set_logger(Logger(folder=None, output_formats=[]))

    def learn(
        self, before: FloatArray, action: int, reward: float, after: FloatArray, *, ended: bool
    ) -> None:
        """Remembers a transition, and makes a training step if there are enough of them."""
        parameters, model = self._parameters, self._model
        model.replay_buffer.add(
            before[None].astype(np.float32),
            after[None].astype(np.float32),
            np.array([action]),
            np.array([reward], dtype=np.float32),
            np.array([ended]),
            [{}],
        )
        self.transitions += 1
        if self.transitions < max(min(parameters.learning_starts, parameters.replay), 1):
            return
        if self._steps % parameters.target_update == 0:
            model.q_net_target.load_state_dict(model.q_net.state_dict())
        with self._seed_libraries(self._steps):
            model.train(gradient_steps=1, batch_size=parameters.batch)
        self._steps += 1

    def layers(self) -> list[Layer]:
        """Returns the layers of the network."""
        linear = [one for one in self._model.q_net.q_net if hasattr(one, "weight")]
        return [
            tuple(part.detach().numpy().astype(np.float64) for part in (one.weight, one.bias))
            for one in linear
        ]

    def state(self) -> bytes:
        """Returns all that later steps depend on."""
        import torch

        model, buffer = self._model, self._model.replay_buffer
        file = io.BytesIO()
        torch.save(
            {
                "network": model.q_net.state_dict(),
                "target": model.q_net_target.state_dict(),
                "optimizer": model.policy.optimizer.state_dict(),
                "counts": torch.tensor([self.transitions, self._steps, buffer.pos]),
                "full": torch.tensor(buffer.full),
                **{name: torch.from_numpy(getattr(buffer, name)) for name in _TABLES},
            },
            file,
        )
        return file.getvalue()

    def restore(self, state: bytes) -> None:
        """Takes what :meth:`state` returned.

        Raises:
            SearchError: It is no state of such a network.
        """
        import torch

        model, buffer = self._model, self._model.replay_buffer
        try:
            # Tensors and plain containers only: nothing in the file is executed.
            content = torch.load(io.BytesIO(state), weights_only=True)
            model.q_net.load_state_dict(content["network"])
            model.q_net_target.load_state_dict(content["target"])
            model.policy.optimizer.load_state_dict(content["optimizer"])
            self.transitions, self._steps, buffer.pos = content["counts"].tolist()
            buffer.full = bool(content["full"])
            for name in _TABLES:
                getattr(buffer, name)[...] = content[name].numpy()
        except Exception as error:
            raise SearchError(
                f"the checkpoint of the adversary cannot be read: {error}. Remove the campaign's "
                "folder `checkpoints`, and resume it: the evaluations are learnt from again"
            ) from error

    @contextlib.contextmanager
    def _seed_libraries(self, number: int) -> Iterator[None]:
        """Seeds the random numbers of the libraries for one use of them, and puts them back."""
        import torch

        drawn = np.random.SeedSequence([self._seed, number]).generate_state(2)
        # Not torch.manual_seed, which also notes a stack trace for each kind of device, in a list
        # that grows with every call and in a fifth of the time of a training step.
        generator = torch.default_generator
        of_torch = generator.get_state()
        of_numpy = np.random.get_state()  # noqa: NPY002  # what the replay buffer draws from
        generator.manual_seed(int(drawn[1]))
        np.random.seed(drawn[0])  # noqa: NPY002  # as above
        try:
            yield
        finally:
            generator.set_state(of_torch)
            np.random.set_state(of_numpy)  # noqa: NPY002  # as above


_TABLES = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
"""The arrays of the replay buffer."""
