"""A Gymnasium environment in which an adversary learns to make an ADS fail.

It needs the extra ``adversary``. SUMO allows one episode a process, so a process has one
environment at work: ``reset`` ends the episode before, also that of another environment.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.adversaries.game import Game
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.errors import ConfigurationError, SimulatorError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Trace
from drivora_service.runs.adversary import ACTIONS, OBSERVATION_SIZE
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode

try:
    import gymnasium
    from gymnasium import spaces
except ModuleNotFoundError as error:
    raise ConfigurationError(
        "the environment of an adversary needs Gymnasium, which is not installed: install "
        "the extra 'adversary' (pip install '.[adversary]' in the checkout)"
    ) from error

View = NDArray[np.float32]
_SEEDS = 2**31


class AdversaryEnv(gymnasium.Env[View, np.int64]):  # type: ignore[misc]  # untyped where missing
    """An episode in which the caller acts against the ADS.

    - Actions: ``Discrete(19)``, the places of ``drivora_service.runs.adversary.ACTIONS``.
    - Observations: ``Box(-1, 1, (39,))``, see ``drivora_service.adversaries.adversary_view``.
    - Rewards: 1 for a collision of the ego, else the greatest probability of one since the action
      if that is at least 0.2, else -1.
    - ``terminated``: the ego has collided, arrived, or got stuck; ``truncated``: time is up.
    - ``info`` of a step: ``time`` in seconds, and the ``intervention`` as plain data.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  # as Gymnasium declares it

    def __init__(
        self,
        scenario: Scenario,
        network: RoadNetwork,
        agents: AgentCatalogue,
        *,
        interval: float = 6.0,
    ) -> None:
        """Prepares episodes of a scenario.

        Args:
            scenario: A valid scenario; its first ego is the one to act against.
            network: Its road network.
            agents: Catalogue with the ADSs that it names.
            interval: Seconds of simulation between two actions.
        """
        self._scenario, self._network, self._agents = scenario, network, agents
        self._interval = interval
        self._game: Game | None = None
        self.action_space = spaces.Discrete(len(ACTIONS))
        self.observation_space = spaces.Box(-1.0, 1.0, (OBSERVATION_SIZE,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[View, dict[str, Any]]:
        """Begins a new episode; what is drawn in it follows from ``seed``.

        Without a seed, each episode has another one, drawn after those before.
        """
        super().reset(seed=seed, options=options)
        scenario = replace(self._scenario, seed=int(self.np_random.integers(_SEEDS)))
        choices = [ego.agent for ego in scenario.ego_vehicles]
        self._agents.begin_run()
        episode = Episode(
            plan_episode(scenario, self._network),
            [self._agents.create(choice.name, choice.parameters) for choice in choices],
            privileged=[self._agents.entry(choice.name).privileged for choice in choices],
            mirrored=any(self._agents.may_read_sumo(choice.name) for choice in choices),
        )
        self._game = Game(episode, interval=self._interval)
        return self._game.observation.astype(np.float32), {"time": 0.0}

    def step(self, action: np.int64) -> tuple[View, float, bool, bool, dict[str, Any]]:
        """Does an action, and simulates until the next one.

        Raises:
            SimulatorError: No episode was begun, or it has ended.
            AgentError: An ADS fails.
        """
        outcome = self.game.decide(int(action))
        info = {
            "time": self.game.episode.time,
            "intervention": outcome.intervention.to_json(),
        }
        view = outcome.observation.astype(np.float32)
        return view, outcome.reward, outcome.ended, outcome.out_of_time, info

    @property
    def game(self) -> Game:
        """The game of the present episode.

        Raises:
            SimulatorError: No episode was begun.
        """
        if self._game is None:
            raise SimulatorError("no episode was begun: call reset first")
        return self._game

    @property
    def scenario(self) -> Scenario:
        """The scenario of the present episode with what was done: a run of it is the episode."""
        return self.game.scenario

    def finish(self) -> Trace:
        """Runs the present episode to its end, without further actions, and returns its trace."""
        return self.game.finish()
