"""The session of a web page."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from drivora_service.api.schemas.base import Schema


class SessionRequest(Schema):
    """What a session begins with."""

    token: str = Field(min_length=1, max_length=200, description="An API token.")


class SessionState(Schema):
    """What a client may do."""

    tokens_needed: bool = Field(description="Whether requests need a token or a session.")
    scope: Literal["read", "submit", "admin"] | None = Field(
        description="What the client may do; null: nothing before it has a token or a session. "
        "Where no token is needed, everything."
    )
    name: str | None = Field(description="Name of the client's token; null without one.")
