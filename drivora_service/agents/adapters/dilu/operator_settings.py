"""The operator's settings of the language model, in environment variables of the service.

The manifest lists them; documents have no access to them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import httpx

from drivora_service.agents.adapters.dilu.models import ModelError

ENDPOINT, MODEL = "DRIVORA_DILU_ENDPOINT", "DRIVORA_DILU_MODEL"
API_KEY, TIMEOUT = "DRIVORA_DILU_API_KEY", "DRIVORA_DILU_TIMEOUT_S"
_TIMEOUT_S = 8.0
"""Below the ten seconds after which a call of an agent counts as hung."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndpointSettings:
    """An OpenAI-compatible service.

    Attributes:
        url: Base address of its API, without a slash at the end: https://HOST/v1.
        model: Name of the model there.
        api_key: "" for none.
        timeout: Seconds for all requests of one step.
    """

    url: str
    model: str
    api_key: str = ""
    timeout: float = _TIMEOUT_S

    def __repr__(self) -> str:
        # Printed text goes to the log, which must not contain the key.
        return f"EndpointSettings(url={self.url!r}, model={self.model!r})"


def read_endpoint_settings(variables: Mapping[str, str]) -> EndpointSettings | None:
    """Reads the settings; ``None`` without an endpoint.

    Raises:
        ModelError: They are invalid.
    """
    text = variables.get(ENDPOINT, "").strip().rstrip("/")
    if not text:
        return None
    _check_url(text)
    model = variables.get(MODEL, "").strip()
    if not model:
        raise ModelError(f"{ENDPOINT} is set, {MODEL} is not: name the model to ask there")
    key = variables.get(API_KEY, "").strip()
    if not (key.isascii() and key.isprintable()):
        raise ModelError(f"{API_KEY} holds what no HTTP header may; allowed: printable ASCII")
    return EndpointSettings(
        url=text,
        model=model,
        api_key=key,
        timeout=_seconds(variables.get(TIMEOUT, "")),
    )


def _check_url(text: str) -> None:
    allowed = "allowed: http:// or https://, a host and a path, such as http://localhost:8080/v1"
    try:
        url = httpx.URL(text)
    except httpx.InvalidURL:
        # Without the text, which may contain secrets.
        raise ModelError(f"{ENDPOINT} is no address; {allowed}") from None
    if url.scheme not in ("http", "https") or not url.host:
        raise ModelError(f"{ENDPOINT} has no scheme or host; {allowed}")
    if url.userinfo or url.query:
        raise ModelError(f"{ENDPOINT} holds a user or a query; {allowed}. A key goes to {API_KEY}")


def _seconds(text: str) -> float:
    try:
        seconds = float(text or _TIMEOUT_S)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds < math.inf:
        raise ModelError(f"{TIMEOUT} is {text!r}; allowed: seconds above 0")
    return seconds
