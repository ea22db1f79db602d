"""Parameters of DeepCollision."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from pydantic import Field

from drivora_service.search.budget_bounds import MANY

Share = Annotated[float, Field(ge=0.0, le=1.0)]


class Scene(StrEnum):
    """What the adversary begins with."""

    SEED = "seed"
    """The seed scenario, without variable actors, in fine weather."""
    DRAWN = "drawn"
    """A candidate that is drawn from the gene space for each run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeepcollisionParameters:
    """Parameters of DeepCollision. "Code" is the public code of the paper.

    Attributes:
        scene: What the adversary begins with (paper: always the same).
        interval: Seconds of simulation between two decisions (paper: 4, 6, 8 or 10).
        hidden: Neurons of each of the two hidden layers (code: 200).
        learning_rate: Step size of the optimiser (code: 0.01).
        batch: Transitions of a training step (paper and code: 32).
        replay: Transitions that are remembered (paper and code: 2,000).
        learning_starts: Transitions before the first training step (code: 2,000).
        discount: Factor of later rewards (paper and code: 0.9).
        target_update: Training steps between two updates of the target network (code: 100).
        first_exploration: Probability of a decision by lot at the beginning (code: 1); 1 for both
            is an adversary without feedback.
        last_exploration: The same after many decisions (code: 0.1).
        exploration_steps: Decisions in which the difference between the two falls to its e-th part
            (code: 6,000).
        checkpoint_every: Evaluations between two checkpoints (code: 50 episodes); 0 for none.
    """

    scene: Scene = Scene.SEED
    interval: Annotated[float, Field(ge=1.0, le=60.0)] = 6.0
    hidden: Annotated[int, Field(ge=1, le=1000)] = 200
    learning_rate: Annotated[float, Field(gt=0.0)] = 0.01
    batch: Annotated[int, Field(ge=1, le=10_000)] = 32
    replay: Annotated[int, Field(ge=1, le=MANY)] = 2000
    learning_starts: Annotated[int, Field(ge=1, le=MANY)] = 2000
    discount: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.9
    target_update: Annotated[int, Field(ge=1, le=MANY)] = 100
    first_exploration: Share = 1.0
    last_exploration: Share = 0.1
    exploration_steps: Annotated[int, Field(ge=1, le=100 * MANY)] = 6000
    checkpoint_every: Annotated[int, Field(ge=0, le=MANY)] = 50
