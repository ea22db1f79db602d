"""Plug-ins: named feedbacks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.feedback.measurement import Feedback


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedbackPlugin:
    """The object of an entry point of the group ``drivora_service.feedback``.

    The factory takes the parameters of the choice and raises ``SearchError`` if it cannot use them.
    """

    name: str
    description: str
    create: Callable[[Mapping[str, Any]], Feedback]
