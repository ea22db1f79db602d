"""What a language model is asked through, wherever it runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from drivora_service.agents.adapters.dilu.decisions import Decision
from drivora_service.agents.adapters.dilu.prompts import Message


class ModelError(Exception):
    """The model did not answer; the message says what was found and what to do."""


class ChatModel(Protocol):
    """A language model.

    Attributes:
        name: For people, without secrets.
        reasons: Whether it is to think aloud before it decides.
    """

    name: str
    reasons: bool

    def begin_run(self) -> None:
        """Forgets what earlier runs left in it."""
        ...

    def answer(
        self, messages: Sequence[Message], allowed: Sequence[Decision], seconds: float
    ) -> str:
        """Returns the answer to a chat.

        Args:
            messages: The chat so far.
            allowed: Decisions that the answer may hold, for a model that can be held to them.
            seconds: Of wall time in which an answer must come, if waiting for it depends on others.

        Raises:
            ModelError: There is none.
        """
        ...
