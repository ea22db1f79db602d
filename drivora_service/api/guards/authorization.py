"""Authorisation: bearer tokens with scopes, and the sessions that pages begin with them."""

from __future__ import annotations

from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyCookie, HTTPBearer

from drivora_service.api.context import context_of
from drivora_service.api.guards.api_tokens import Scope
from drivora_service.api.guards.page_sessions import COOKIE, Credential, credential_of, token_of
from drivora_service.api.problem_details import ApiError

_bearer = HTTPBearer(
    auto_error=False,
    scheme_name="token",
    description="An API token (`drivora tokens create`); needed once one was made.",
)

_session = APIKeyCookie(
    name=COOKIE,
    auto_error=False,
    scheme_name="session",
    description="The cookie of a session, which `POST /session` begins with a token.",
)

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})

_Bearer = Annotated[object, Depends(_bearer)]
_Cookie = Annotated[object, Depends(_session)]


async def _declare_schemes(bearer: _Bearer, session: _Cookie) -> None:
    """Stands for both ways in the OpenAPI document."""
    del bearer, session


Documented = Annotated[None, Depends(_declare_schemes)]


def require_any(request: Request) -> Credential | None:
    """Returns what a request proves; ``None``: no token is needed.

    Raises:
        ApiError: A token is needed, and it has none (401).
    """
    context = context_of(request)
    tokens = context.needed_tokens
    if tokens is None:
        return None
    credential = credential_of(tokens, context.sessions, request.headers)
    if credential is None:
        raise ApiError(
            HTTPStatus.UNAUTHORIZED,
            "an API token is needed: Authorization: Bearer …",
            headers={"WWW-Authenticate": "Bearer"},
        )
    return credential


def _require(request: Request, scope: Scope) -> None:
    credential = require_any(request)
    if credential is None:
        return
    if credential.is_session and request.method not in _SAFE_METHODS:
        _refuse_other_pages(request)
    token = credential.token
    if token.scope < scope:
        raise ApiError(
            HTTPStatus.FORBIDDEN,
            f"token {token.name!r} has scope {token.scope.name.lower()}; "
            f"{scope.name.lower()} is needed",
        )
    request.state.client = token.name


def _refuse_other_pages(request: Request) -> None:
    """Checks that a request with a session comes from a page of the service.

    The browser says so; the origin guard has compared the origin with the service's address.
    """
    site = request.headers.get("sec-fetch-site", "")
    if site != "same-origin" and (site or "origin" not in request.headers):
        raise ApiError(
            HTTPStatus.FORBIDDEN,
            "a request with a session must come from a page of this service; programs use a token",
        )


def is_valid(request: Request) -> bool:
    """Returns whether a request that was let pass would be let pass now."""
    context = context_of(request)
    tokens = context.needed_tokens
    return tokens is None or token_of(tokens, context.sessions, request.headers) is not None


async def reader(request: Request, _: Documented) -> None:
    """Lets requests pass that may read."""
    _require(request, Scope.READ)


async def submitter(request: Request, _: Documented) -> None:
    """Lets requests pass that may post and cancel."""
    _require(request, Scope.SUBMIT)


async def administrator(request: Request, _: Documented) -> None:
    """Lets requests pass that may change what the service offers to all."""
    _require(request, Scope.ADMIN)


def client_name(request: Request) -> str:
    """Returns the name of the token that a request came with, or ""."""
    name: str = getattr(request.state, "client", "")
    return name
