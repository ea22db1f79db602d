"""The connection of both clients: address, token and time limits."""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import httpx

from drivora_service.client.call import Call
from drivora_service.client.flows import Terms
from drivora_service.client.replies import Service
from drivora_service.errors import ConfigurationError, ServiceError, StoreError

TOKEN_VARIABLE = "DRIVORA_TOKEN"
LOCAL_URL = "http://127.0.0.1"
CLOSED = "the client is closed and asks nothing more; make another one"
RETRY_S = 60.0
TIMEOUT_S = 60.0

OnRetry = Callable[[ServiceError, float], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """Arguments of an HTTP client, and how a service is asked.

    Attributes:
        url: Address that paths are added to.
    """

    url: str
    headers: dict[str, str]
    timeout: httpx.Timeout
    terms: Terms


def connection(
    url: str,
    token: str | None,
    *,
    is_local: bool,
    retry_s: float,
    timeout_s: float,
    on_retry: OnRetry,
) -> Connection:
    """Checks what a client was given.

    Raises:
        ConfigurationError: The address or the token cannot be used.
    """
    address = (url or (LOCAL_URL if is_local else "")).rstrip("/")
    try:
        parsed = httpx.URL(address)
    except httpx.InvalidURL as error:
        raise ConfigurationError(f"{url!r} is no address of a service: {error}") from error
    if parsed.scheme not in ("http", "https") or not parsed.host:
        raise ConfigurationError(
            f"{url!r} is no address of a service; one looks like http://127.0.0.1:8000"
        )
    if parsed.query or parsed.fragment:
        raise ConfigurationError(
            f"{url!r} is no address of a service: it has a ? or #. An address ends with its host, "
            "or with the path that the service is under, such as https://host/drivora"
        )
    token = os.environ.get(TOKEN_VARIABLE, "") if token is None else token
    if not (token.isascii() and token.isprintable()) or " " in token:
        raise ConfigurationError(
            f"the API token (${TOKEN_VARIABLE}) has characters that no token has; "
            "`drivora tokens create` prints one"
        )
    return Connection(
        url=address,
        headers={"Authorization": f"Bearer {token}"} if token else {},
        # What an application in this process computes may take as long as it needs.
        timeout=httpx.Timeout(None if is_local else timeout_s),
        terms=Terms(
            service=Service(url=address, is_local=is_local), retry_s=retry_s, on_retry=on_retry
        ),
    )


def ignore_retry(error: ServiceError, seconds: float) -> None:
    """Ignores that a request is tried again."""
    del error, seconds


def ignore_progress(progress: object) -> None:
    """Ignores progress."""
    del progress


def timeout_of(call: Call[Any], usual: httpx.Timeout) -> httpx.Timeout:
    """Returns the time limits of a call.

    Args:
        call: The call.
        usual: Those of the client.
    """
    if call.answer_s is None or usual.read is None:
        return usual
    read = max(usual.read, call.answer_s)
    return httpx.Timeout(connect=usual.connect, read=read, write=usual.write, pool=usual.pool)


@contextlib.contextmanager
def open_body(call: Call[Any]) -> Iterator[bytes | BinaryIO | None]:
    """Provides the body of a call; a file is open meanwhile.

    Raises:
        StoreError: The file cannot be read.
    """
    if not isinstance(call.body, Path):
        yield call.body
        return
    try:
        file = call.body.open("rb")
    except OSError as error:
        raise StoreError(f"cannot read {call.body}: {error.strerror}") from error
    with file:
        yield file


@contextlib.contextmanager
def open_replacement(path: Path) -> Iterator[BinaryIO]:
    """Opens a file that replaces ``path`` once it is complete.

    Raises:
        StoreError: It cannot be written.
    """
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with partial.open("xb") as file:
            yield file
        partial.replace(path)
    except OSError as error:
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}; free space there, or name another "
            "place"
        ) from error
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
