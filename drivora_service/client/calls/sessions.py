"""The session of a client, in place of a token with every request."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, get

if TYPE_CHECKING:
    from drivora_service.api.schemas.sessions import SessionState

_PATH = f"{PREFIX}/session"


def session() -> Call[SessionState]:
    """Returns what the client may do, also without a token."""
    from drivora_service.api.schemas.sessions import SessionState

    return get(_PATH, SessionState)


def begin_session(token: str) -> Call[None]:
    """Begins a session with a token, as a web page does; its cookie goes with further requests.

    A program needs none: it gives its token with every request.

    Args:
        token: An API token.

    Raises:
        ServiceError: It is wrong, or the service needs none.
    """
    return Call(
        method="POST",
        template=_PATH,
        body=json.dumps({"token": token}).encode(),
        headers={"Content-Type": "application/json"},
        answer=type(None),
        is_repeatable=False,
    )


def end_session() -> Call[None]:
    """Ends the session of the client; without one, nothing changes."""
    return Call(method="DELETE", template=_PATH, answer=type(None), is_repeatable=False)
