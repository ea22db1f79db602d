"""The protocol of language models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from drivora_service.agents.adapters.dilu.decisions import Decision
from drivora_service.agents.adapters.dilu.prompts import Message


class ModelError(Exception):
    """The model did not answer; the message has the cause and what to do."""


class ChatModel(Protocol):
    """A language model.

    Attributes:
        name: Display name, without secrets.
        reasons: Whether it reasons in text before it decides.
    """

    name: str
    reasons: bool

    def begin_run(self) -> None:
        """Clears the state of earlier runs."""
        ...

    def answer(
        self, messages: Sequence[Message], allowed: Sequence[Decision], seconds: float
    ) -> str:
        """Returns the answer to a chat.

        Args:
            messages: The chat so far.
            allowed: Allowed decisions, for a model whose output can be restricted.
            seconds: Wall time for the answer, for a model that is remote.

        Raises:
            ModelError: There is no answer.
        """
        ...
