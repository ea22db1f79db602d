"""The memory: situations with their decisions and reasons.

DiLu compares embeddings of descriptions by a model; here it is the distance of
:func:`~drivora_service.agents.adapters.dilu.situation.features`, which is the same on every
machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from drivora_service.agents.adapters.dilu.decisions import Decision
from drivora_service.agents.adapters.dilu.situation import (
    Beside,
    Neighbour,
    Situation,
    features,
)

SHIPPED = Path(__file__).with_name("memory") / "experiences.yaml"
"""Not beside the manifest, where every YAML file is one."""

_NEW = 0.5
"""Distance to all known situations from which on a situation is kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Experience:
    """A situation with its decision and reason.

    Attributes:
        why: Reason in a sentence.
    """

    situation: Situation
    decision: Decision
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Recalled:
    """An experience that is similar to the present situation.

    Attributes:
        number: Its number in the memory, from 1.
        distance: Its distance.
    """

    number: int
    distance: float
    experience: Experience


class Memory:
    """The experiences of one run: the initial and the added ones."""

    def __init__(self, experiences: Sequence[Experience]) -> None:
        """Args: experiences: Initial experiences, at least one."""
        self.experiences = list(experiences)
        self._features = [features(each.situation) for each in experiences]

    def recall(self, situation: Situation, count: int) -> list[Recalled]:
        """Returns the most similar experiences of a situation, nearest first."""
        away = np.hypot.reduce(np.array(self._features) - features(situation), axis=1)
        return [
            Recalled(number=k + 1, distance=float(away[k]), experience=self.experiences[k])
            for k in np.argsort(away, kind="stable")[:count].tolist()
        ]

    def add(self, experience: Experience) -> int:
        """Adds an experience; returns its number."""
        self.experiences.append(experience)
        self._features.append(features(experience.situation))
        return len(self.experiences)

    def is_new(self, situation: Situation) -> bool:
        """Returns whether a situation differs from all known ones."""
        return self.recall(situation, 1)[0].distance > _NEW


def read_experiences(path: Path = SHIPPED) -> tuple[Experience, ...]:
    """Reads a file of experiences.

    Raises:
        KeyError, TypeError, ValueError: The file is invalid.
    """
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    return tuple(
        Experience(
            situation=_situation(each["situation"]),
            decision=Decision(each["decision"]),
            why=each["why"],
        )
        for each in content
    )


def _situation(found: Mapping[str, Any]) -> Situation:
    rest = dict(found)
    ahead = _neighbour(rest.pop("ahead", None))
    left, right = (_lane(rest.pop(side, None)) for side in ("left", "right"))
    return Situation(ahead=ahead, left=left, right=right, **rest)


def _lane(found: Mapping[str, Any] | str | None) -> Beside | None:
    if found is None:
        return None
    if found == "free":
        return Beside()
    if isinstance(found, str):
        raise ValueError(f"found the lane {found!r}; allowed: free, or the actors ahead and behind")
    return Beside(**{side: _neighbour(found[side]) for side in found})


def _neighbour(found: Sequence[float] | None) -> Neighbour | None:
    return None if found is None else Neighbour(gap=found[0], speed=found[1])
