"""Sessions: a web page gives its token once, and gets a cookie that scripts cannot read."""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Literal, NoReturn

from fastapi import FastAPI, Request, Response

from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, no_content
from drivora_service.api.guards.api_tokens import Scope
from drivora_service.api.guards.page_sessions import COOKIE, LIFETIME, session_secret, token_of
from drivora_service.api.problem_details import ApiError
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.sessions import SessionRequest, SessionState

router = resource_router("session")

_WRONG_S = 1.0
"""Seconds that the answer to a wrong token takes."""
_MOST_WRONG = 8
"""Wrong tokens whose answers are waited for at once; further ones are refused."""
_WRONG = "wrong_tokens"
"""Counts them, in the state of the application."""
_EXAMPLE = {"token": "drv_9QF0m1S2cN7xYk3bT5uWvA8hJ4eL6pRzGdXoIiKqMtE"}
_NOT_STORED = {"Cache-Control": "no-store"}

_SCOPES: dict[Scope, Literal["read", "submit", "admin"]] = {
    Scope.READ: "read",
    Scope.SUBMIT: "submit",
    Scope.ADMIN: "admin",
}


@router.post(
    "/session",
    status_code=204,
    responses=no_content(401, 403, 409, 422, 429, 503),
    openapi_extra={"requestBody": {"content": {"application/json": {"example": _EXAMPLE}}}},
)
async def begin_session(request: Request, context: Context, given: SessionRequest) -> Response:
    """Begins a session with a token; its cookie is accepted wherever a token is.

    The cookie is not readable by scripts and is sent by pages of this site only. The session lasts
    14 days, outlasts restarts of the service, and ends with its token. Wrong tokens are answered
    slowly.
    """
    tokens, sessions = context.needed_tokens, context.sessions
    if tokens is None or sessions is None:
        raise ApiError(HTTPStatus.CONFLICT, "this service needs no token, and so no session")
    token = tokens.find(given.token)
    if token is None:
        await _refuse_slowly(request.app)
    secret = await asyncio.to_thread(sessions.begin, token)
    response = Response(status_code=204, headers=_NOT_STORED)
    response.set_cookie(
        COOKIE,
        secret,
        max_age=int(LIFETIME.total_seconds()),
        path=context.root_path or "/",
        secure=_is_https(request, context),
        httponly=True,
        samesite="strict",
    )
    return response


@router.get("/session", response_model=SessionState, responses=answers(recorded_examples.SESSION))
async def get_session(request: Request, context: Context, response: Response) -> SessionState:
    """Returns what the client may do, also to one without a token."""
    response.headers.update(_NOT_STORED)
    tokens = context.needed_tokens
    if tokens is None:
        return SessionState(tokens_needed=False, scope="admin", name=None)
    token = token_of(tokens, context.sessions, request.headers)
    return SessionState(
        tokens_needed=True,
        scope=None if token is None else _SCOPES[token.scope],
        name=None if token is None else token.name,
    )


@router.delete("/session", status_code=204, responses=no_content(403, 503))
async def end_session(request: Request, context: Context) -> Response:
    """Ends the session of the request; without one, nothing changes."""
    secret = session_secret(request.headers)
    if context.sessions is not None and secret:
        await asyncio.to_thread(context.sessions.end, secret)
    response = Response(status_code=204, headers=_NOT_STORED)
    response.delete_cookie(
        COOKIE,
        path=context.root_path or "/",
        secure=_is_https(request, context),
        httponly=True,
        samesite="strict",
    )
    return response


async def _refuse_slowly(api: FastAPI) -> NoReturn:
    """Refuses a wrong token after a while, so that many cannot be tried."""
    waiting: int = getattr(api.state, _WRONG, 0)
    if waiting >= _MOST_WRONG:
        raise ApiError(
            HTTPStatus.TOO_MANY_REQUESTS,
            "too many wrong tokens at once; try again in a few seconds",
            headers={"Retry-After": "3"},
        )
    setattr(api.state, _WRONG, waiting + 1)
    try:
        await asyncio.sleep(_WRONG_S)
    finally:
        setattr(api.state, _WRONG, getattr(api.state, _WRONG) - 1)
    raise ApiError(
        HTTPStatus.UNAUTHORIZED,
        "this is no token of this service; `drivora tokens create` makes one",
        headers={"WWW-Authenticate": "Bearer"},
    )


def _is_https(request: Request, context: ApiContext) -> bool:
    """Returns whether the page was loaded by HTTPS, also through a proxy that ends it.

    A client that claims so in a header gets a cookie that its browser does not send without it.
    """
    forwarded = request.headers.get("x-forwarded-proto", "")
    schemes = (request.url.scheme, forwarded.partition(",")[0].strip().lower())
    return context.is_public_https or "https" in schemes
