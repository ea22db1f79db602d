"""DeepCollision as ask and tell.

Lu, Shi, Zhang, Zhang, Yue, Ali, *Learning Configurations of Operating Environment of Autonomous
Vehicles to Maximize their Collisions* (IEEE Transactions on Software Engineering, 2022), with the
details of its public code. The reference page explains the adaptations.

A proposal carries the present policy; a worker plays the run with it and returns what it saw, did
and was rewarded for; the tester trains the policy with that.
"""

from __future__ import annotations

import json
import math
from importlib.util import find_spec

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.adversary import (
    DECISIONS,
    OBSERVATION_SIZE,
    OBSERVATIONS,
    AdversarySource,
    layers_to_text,
)
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.deepcollision.learner import Learner
from drivora_service.search.testers.deepcollision.parameters import (
    DeepcollisionParameters,
    Scene,
)
from drivora_service.search.testers.turn import Turn

_MODULES = ("gymnasium", "stable_baselines3", "torch")
_SEEDS = 2**31
_HIGHEST_SUN = "sun_altitude_angle"
"""The one condition of the weather that is fine at its greatest value."""


class DeepcollisionTester:
    """Proposes runs with the present policy, and trains it with what came of them."""

    def __init__(self, context: TesterContext, parameters: DeepcollisionParameters) -> None:
        self._context, self._parameters = context, parameters
        self._turn = Turn()
        self._seed = int(context.random.integers(_SEEDS))
        self._still = still_values(context.space)
        self._made: Learner | None = None
        self._told = self._decisions = 0
        self._policy = ""
        self._open: dict[int, str] = {}
        self._restores_at, self._state = -1, b""
        self._opened: dict[int, str] = {}
        last = None if context.checkpoints is None else context.checkpoints.last()
        if last is not None:
            self._restores_at, content = last
            self._opened, self._state = _unpack_checkpoint(content)

    @property
    def _learner(self) -> Learner:
        """Made when it is needed, since the libraries take long to load."""
        if self._made is None:
            self._made = Learner(self._parameters, self._seed)
        return self._made

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes as many runs as there is room for."""
        return self._turn.propose(tuple(self._proposal(k) for k in range(max(room, 0))), room)

    def _proposal(self, place: int) -> Proposal:
        number = self._turn.next_number + place
        values, random = self._still.copy(), self._context.random
        if self._parameters.scene is Scene.DRAWN:
            values = self._context.space.sample(random)
        policy = self._present_policy(number)
        self._open[number] = policy
        return Proposal(
            values=values,
            origin="random" if self._exploration >= 1.0 else "policy",
            adversary=AdversarySource(
                policy=policy,
                exploration=self._exploration,
                seed=int(random.integers(_SEEDS)),
                interval=self._parameters.interval,
            ),
        )

    @property
    def _exploration(self) -> float:
        parameters = self._parameters
        first, last = parameters.first_exploration, parameters.last_exploration
        return last + (first - last) * math.exp(-self._decisions / parameters.exploration_steps)

    def _present_policy(self, number: int) -> str:
        if self._told < self._restores_at:
            # On the way to a checkpoint: what has been told already is not run again, and the
            # checkpoint has the policies of what had been asked for and not told.
            return self._opened.get(number, "")
        if self._exploration >= 1.0:
            return ""
        if not self._policy:
            self._policy = layers_to_text(self._learner.layers())
        return self._policy

    def tell(self, evaluation: Evaluation) -> None:
        """Trains the policy with a run."""
        self._turn.take(evaluation)
        del self._open[evaluation.number]
        self._told += 1
        transitions = _transitions(evaluation)
        self._decisions += len(transitions)
        if self._told < self._restores_at:
            return
        if self._told == self._restores_at:
            self._restore()
            return
        # One that decides by lot for good learns nothing that it would use.
        if not self._is_blind:
            for before, action, reward, after, ended in transitions:
                self._learner.learn(before, action, reward, after, ended=ended)
            if transitions:
                self._policy = ""
        self._save_if_due()

    @property
    def _is_blind(self) -> bool:
        parameters = self._parameters
        return min(parameters.first_exploration, parameters.last_exploration) >= 1.0

    def _restore(self) -> None:
        if self._state:
            self._learner.restore(self._state)
            if self._learner.transitions != self._decisions:
                raise SearchError(
                    f"the checkpoint of the adversary has learnt from {self._learner.transitions} "
                    f"decisions; the {self._told} evaluations before it have {self._decisions}. "
                    "Remove the campaign's folder `checkpoints`, and resume it"
                )
        self._policy, self._state = "", b""

    def _save_if_due(self) -> None:
        every, checkpoints = self._parameters.checkpoint_every, self._context.checkpoints
        if checkpoints is None or not every or self._told % every:
            return
        state = b"" if self._is_blind else self._learner.state()
        checkpoints.save(self._told, _pack_checkpoint(self._open, state))


def _transitions(
    evaluation: Evaluation,
) -> list[tuple[FloatArray, int, float, FloatArray, bool]]:
    """Returns the decisions of a run: situation, action, reward, next situation, end."""
    measurement = evaluation.measurement
    if measurement is None or not measurement.features.get(DECISIONS):
        return []
    views = np.array(measurement.features[OBSERVATIONS])
    decisions = measurement.features[DECISIONS]
    if views.shape != (len(decisions) + 1, OBSERVATION_SIZE):
        raise SearchError(
            f"evaluation {evaluation.number} has {len(decisions)} decisions and situations of "
            f"shape {views.shape}; needed are {OBSERVATION_SIZE} values before and after each"
        )
    return [
        (views[k], int(action), reward, views[k + 1], ended > 0.0)
        for k, (action, reward, ended) in enumerate(decisions)
    ]


def still_values(space: GeneSpace) -> FloatArray:
    """Returns the values without variable actors and patches, in fine weather.

    All else is in the middle.
    """
    values = space.from_unit(np.full(len(space), 0.5))
    for block in space.blocks:
        if block.is_optional:
            values[block.index("present")] = 0.0
        if block.part is Part.WEATHER:
            for k, gene in enumerate(block.genes, block.start):
                values[k] = gene.high if gene.name == _HIGHEST_SUN else gene.low
    return values


def _pack_checkpoint(policies: dict[int, str], state: bytes) -> bytes:
    """Writes a checkpoint: the policies of proposals that are not told yet, and the state."""
    return json.dumps({str(k): text for k, text in policies.items()}).encode() + b"\n" + state


def _unpack_checkpoint(content: bytes) -> tuple[dict[int, str], bytes]:
    policies, _, state = content.partition(b"\n")
    try:
        return {int(k): str(text) for k, text in json.loads(policies).items()}, state
    except (ValueError, AttributeError) as error:
        raise SearchError(
            f"the checkpoint of the adversary cannot be read: {error}. Remove the campaign's "
            "folder `checkpoints`, and resume it: the evaluations are learnt from again"
        ) from error


def missing_modules() -> tuple[str, ...]:
    """Returns the modules that the tester needs and that are not installed."""
    return tuple(name for name in _MODULES if find_spec(name) is None)


def _create(
    context: TesterContext, parameters: DeepcollisionParameters, _components: Components
) -> DeepcollisionTester:
    missing = missing_modules()
    if missing:
        raise SearchError(
            f"tester 'deepcollision' needs {', '.join(missing)}, which is not installed: install "
            "the extra 'adversary' (pip install '.[adversary]' in the checkout)"
        )
    return DeepcollisionTester(context, parameters)


DEEPCOLLISION = TesterPlugin(
    name="deepcollision",
    title="DeepCollision",
    description="an adversary that acts during the runs and learns by deep Q-learning",
    source="Lu et al., TSE 2022",
    parameters=DeepcollisionParameters,
    feedback=FeedbackChoice(name="deepcollision"),
    create=_create,
    is_generational=False,
    packages=("gymnasium", "stable-baselines3", "torch"),
)
