"""Sessions of web pages: begun with a token, kept by the service, known to the page by a cookie.

A session has the scope of its token and ends with it. Its secret has 256 random bits and is kept as
a hash, as tokens are.
"""

from __future__ import annotations

import hashlib
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from starlette.datastructures import Headers

from drivora_service.api.guards.api_tokens import StoredToken, TokenFile
from drivora_service.api.guards.secret_files import (
    FileVersion,
    read_secret_file,
    secret_file,
    write_secret_file,
)
from drivora_service.errors import CredentialsUnusable, StoreError

COOKIE = "drivora_session"
"""Name of the cookie with the secret of a session."""

LIFETIME = timedelta(days=14)
"""After which a page asks for a token again."""
MOST_SESSIONS = 1000
"""The oldest ends with the beginning of one more."""


class StoredSession(BaseModel):
    """A session at rest; its token is known by its hash, too."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    sha256: str
    token_sha256: str
    expires: datetime


_SESSIONS = TypeAdapter(list[StoredSession])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Loaded:
    """What a version of the file says.

    Attributes:
        version: That version; ``None``: the file does not exist.
        by_hash: Its sessions.
    """

    version: FileVersion | None
    by_hash: dict[str, StoredSession]


class SessionFile:
    """The sessions of one installation; they outlast a restart of the service.

    They are found in the event loop, which therefore never waits for one who writes them.
    """

    def __init__(self, path: Path, tokens: TokenFile) -> None:
        """Reads nothing yet.

        Args:
            path: File of the sessions, which its owner only may read.
            tokens: Tokens with which sessions begin and end.
        """
        self._path, self._tokens = path, tokens
        self._lock = threading.Lock()
        self._loaded = _Loaded(version=None, by_hash={})

    def begin(self, token: StoredToken) -> str:
        """Adds a new session and returns its secret, which is not kept.

        Raises:
            CredentialsUnusable: The file cannot be read or written.
        """
        secret = secrets.token_urlsafe(32)
        session = StoredSession(
            sha256=_hash(secret), token_sha256=token.sha256, expires=datetime.now(UTC) + LIFETIME
        )
        with self._turn():
            known = {one.sha256 for one in self._tokens.all()}
            live = [
                one
                for one in self._sessions().values()
                if one.token_sha256 in known and one.expires > datetime.now(UTC)
            ]
            self._write([*live[-MOST_SESSIONS + 1 :], session])
        return secret

    def end(self, secret: str) -> None:
        """Ends a session, if it is one of ours.

        Raises:
            CredentialsUnusable: The file cannot be read or written.
        """
        with self._turn():
            sessions = self._sessions()
            if _hash(secret) in sessions:
                self._write([one for key, one in sessions.items() if key != _hash(secret)])

    def find(self, secret: str) -> StoredToken | None:
        """Returns the token of a session; ``None``: it has ended, or is not one of ours.

        Raises:
            CredentialsUnusable: The file cannot be read.
        """
        session = self._sessions().get(_hash(secret))
        if session is None or session.expires <= datetime.now(UTC):
            return None
        return self._tokens.by_hash(session.token_sha256)

    def _sessions(self) -> dict[str, StoredSession]:
        loaded = self._loaded
        version = self._version_of_file()
        if version == loaded.version:
            return loaded.by_hash
        try:
            found = _SESSIONS.validate_json(read_secret_file(self._path))
        except FileNotFoundError:
            found = []
        except (OSError, ValidationError) as error:
            raise CredentialsUnusable(
                f"{self._path} cannot be used: {error}; removing it ends all sessions of pages"
            ) from error
        # The version was read first: where the content is newer, the next look reads it again.
        self._loaded = loaded = _Loaded(version=version, by_hash=_by_hash(found))
        return loaded.by_hash

    def _version_of_file(self) -> FileVersion | None:
        try:
            return FileVersion.of(self._path)
        except OSError as error:
            raise CredentialsUnusable(f"{self._path} cannot be used: {error}") from error

    @contextmanager
    def _turn(self) -> Iterator[None]:
        """Has threads, and servers that share the folder, begin and end sessions in turn."""
        try:
            with self._lock, secret_file(self._path):
                yield
        except StoreError as error:
            raise CredentialsUnusable(str(error)) from error

    def _write(self, sessions: list[StoredSession]) -> None:
        write_secret_file(self._path, _SESSIONS.dump_json(sessions, indent=2))
        self._loaded = _Loaded(version=self._version_of_file(), by_hash=_by_hash(sessions))


def session_secret(headers: Headers) -> str:
    """Returns the secret of a request's session, "" without one."""
    # Where another service is at the root of the same host, the cookies of both come: first the one
    # of the longer path, which is of this service.
    for cookie in headers.get("cookie", "").split(";"):
        name, _, value = cookie.partition("=")
        if name.strip() == COOKIE:
            return value.strip()
    return ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Credential:
    """What a request proves.

    Attributes:
        token: The token that it carries, or with which its session began.
        is_session: Whether it came as a cookie, which browsers send by themselves.
    """

    token: StoredToken
    is_session: bool


def credential_of(
    tokens: TokenFile, sessions: SessionFile | None, headers: Headers
) -> Credential | None:
    """Returns what a request proves; a token that it carries counts before a session.

    Other kinds of authorisation than ``Bearer`` count for nothing: they may be for a proxy.

    Raises:
        CredentialsUnusable: The file of the tokens or of the sessions cannot be used.
    """
    kind, _, secret = headers.get("authorization", "").partition(" ")
    if kind.lower() == "bearer":
        token = tokens.find(secret.strip())
        return None if token is None else Credential(token=token, is_session=False)
    session = session_secret(headers)
    token = sessions.find(session) if session and sessions is not None else None
    return None if token is None else Credential(token=token, is_session=True)


def token_of(
    tokens: TokenFile, sessions: SessionFile | None, headers: Headers
) -> StoredToken | None:
    """Returns the token with which a request comes; one that it carries counts before a session.

    Raises:
        CredentialsUnusable: The file of the tokens or of the sessions cannot be used.
    """
    credential = credential_of(tokens, sessions, headers)
    return None if credential is None else credential.token


def _by_hash(sessions: list[StoredSession]) -> dict[str, StoredSession]:
    return {session.sha256: session for session in sessions}


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
