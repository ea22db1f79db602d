"""Authorisation: bearer tokens with scopes."""

from __future__ import annotations

from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from drivora_service.api.context import ApiContext, context_of
from drivora_service.api.problems import ApiError
from drivora_service.api.tokens import Scope

_bearer = HTTPBearer(
    auto_error=False,
    scheme_name="token",
    description="An API token (`drivora tokens create`); not asked for on loopback.",
)

Credentials = Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)]


def _require(
    request: Request, credentials: HTTPAuthorizationCredentials | None, scope: Scope
) -> None:
    tokens = context_of(request).tokens
    if tokens is None:
        return
    token = tokens.find(credentials.credentials) if credentials is not None else None
    if token is None:
        raise ApiError(
            HTTPStatus.UNAUTHORIZED,
            "an API token is needed: Authorization: Bearer …",
            headers={"WWW-Authenticate": "Bearer"},
        )
    if token.scope < scope:
        raise ApiError(
            HTTPStatus.FORBIDDEN,
            f"token {token.name!r} has scope {token.scope.name.lower()}; "
            f"{scope.name.lower()} is needed",
        )
    request.state.client = token.name


def is_valid(context: ApiContext, credentials: HTTPAuthorizationCredentials | None) -> bool:
    """Returns whether a request that was let pass would be let pass now."""
    if context.tokens is None:
        return True
    return credentials is not None and context.tokens.find(credentials.credentials) is not None


async def reader(request: Request, credentials: Credentials) -> None:
    """Lets requests pass that may read."""
    _require(request, credentials, Scope.READ)


async def submitter(request: Request, credentials: Credentials) -> None:
    """Lets requests pass that may post and cancel."""
    _require(request, credentials, Scope.SUBMIT)


def client_name(request: Request) -> str:
    """Returns the name of the token that a request came with, or ""."""
    name: str = getattr(request.state, "client", "")
    return name
