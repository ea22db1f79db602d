"""A model behind an OpenAI-compatible endpoint, asked over HTTP."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import httpx

from drivora_service.agents.adapters.dilu.decisions import Decision
from drivora_service.agents.adapters.dilu.models import ModelError
from drivora_service.agents.adapters.dilu.operator_settings import (
    API_KEY,
    ENDPOINT,
    TIMEOUT,
    EndpointSettings,
)
from drivora_service.agents.adapters.dilu.prompts import Message

_CONNECT_S = 3.0
_TOKENS = 600
_SHOWN = 300
"""Characters of an answer in an error."""


class EndpointModel:
    """Sends chats to ``POST {url}/chat/completions``."""

    reasons = True

    def __init__(self, settings: EndpointSettings) -> None:
        self._settings = settings
        self.name = f"{settings.model} at {settings.url}"
        headers = {"Authorization": f"Bearer {settings.api_key}"} if settings.api_key else {}
        self._client = httpx.Client(headers=headers)

    def begin_run(self) -> None:
        """Does nothing: the endpoint manages its own state."""

    def answer(
        self,
        messages: Sequence[Message],
        allowed: Sequence[Decision],  # noqa: ARG002 - of the protocol; the messages list them
        seconds: float,
    ) -> str:
        """Returns the answer to a chat; see :class:`ChatModel`."""
        url = f"{self._settings.url}/chat/completions"
        body = {
            "model": self._settings.model,
            "messages": [asdict(message) for message in messages],
            "temperature": 0,
            "max_tokens": _TOKENS,
        }
        # No second attempt: a step has its deadline, and a run without answers is invalid.
        try:
            response = self._client.post(
                url, json=body, timeout=httpx.Timeout(seconds, connect=min(_CONNECT_S, seconds))
            )
        except httpx.TimeoutException as error:
            raise ModelError(
                f"{url} did not answer within {seconds:.1f} s ({type(error).__name__}). Use a "
                f"faster model, or raise {TIMEOUT} and DRIVORA_AGENT_DEADLINE_S with it"
            ) from error
        except httpx.HTTPError as error:
            raise ModelError(
                f"{url} cannot be reached: {error}. See that it runs, and that {ENDPOINT} is right"
            ) from error
        if response.status_code in (401, 403):
            raise self._unusable(response, f"see that {API_KEY} is right")
        if not response.is_success:
            raise self._unusable(response, "what it says is the endpoint's own")
        return self._content(response)

    def _content(self, response: httpx.Response) -> str:
        try:
            content = response.json()["choices"][0]["message"]["content"]
        except (ValueError, KeyError, IndexError, TypeError):
            content = None
        if not isinstance(content, str):
            raise self._unusable(
                response, f"that is no chat completion; see that {ENDPOINT} is one"
            )
        return content

    def _unusable(self, response: httpx.Response, advice: str) -> ModelError:
        text = " ".join(response.text[:_SHOWN].split())
        if self._settings.api_key:
            text = text.replace(self._settings.api_key, "[the API key]")
        return ModelError(
            f"{response.request.url} answered {response.status_code} with {text!r}: {advice}"
        )
