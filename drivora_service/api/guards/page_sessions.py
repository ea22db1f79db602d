"""Sessions of web pages: begun with a token, kept by the service, known to the page by a cookie.

A session has the scope of its token and ends with it. Its secret has 256 random bits and is kept as
a hash, as tokens are.
"""

from __future__ import annotations

import hashlib
import os
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

from filelock import UnixFileLock
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from starlette.datastructures import Headers

from drivora_service.api.guards.api_tokens import StoredToken, TokenFile
from drivora_service.errors import ConfigurationError

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
_NO_VERSION = (0, 0)
"""Of a file that does not exist."""


class SessionFile:
    """The sessions of one installation; they outlast a restart of the service."""

    def __init__(self, path: Path, tokens: TokenFile) -> None:
        """Reads nothing yet.

        Args:
            path: File of the sessions, which its owner only may read.
            tokens: Tokens with which sessions begin and end.
        """
        self._path, self._tokens = path, tokens
        self._lock = threading.Lock()
        # Servers that share the folder begin and end sessions in turn.
        self._writing = UnixFileLock(path.with_suffix(".lock"), thread_local=False, mode=0o600)
        self._loaded: dict[str, StoredSession] = {}
        self._version = _NO_VERSION

    def begin(self, token: StoredToken) -> str:
        """Adds a new session and returns its secret, which is not kept.

        Raises:
            ConfigurationError: The file cannot be read or written.
        """
        secret = secrets.token_urlsafe(32)
        session = StoredSession(
            sha256=_hash(secret), token_sha256=token.sha256, expires=datetime.now(UTC) + LIFETIME
        )
        with self._lock, self._turn():
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
            ConfigurationError: The file cannot be read or written.
        """
        with self._lock, self._turn():
            sessions = self._sessions()
            if _hash(secret) in sessions:
                self._write([one for key, one in sessions.items() if key != _hash(secret)])

    def find(self, secret: str) -> StoredToken | None:
        """Returns the token of a session; ``None``: it has ended, or is not one of ours.

        Raises:
            ConfigurationError: The file cannot be read.
        """
        with self._lock:
            session = self._sessions().get(_hash(secret))
        if session is None or session.expires <= datetime.now(UTC):
            return None
        return self._tokens.by_hash(session.token_sha256)

    def _sessions(self) -> dict[str, StoredSession]:
        version = self._version_of_file()
        if version == self._version:
            return self._loaded
        try:
            found = _SESSIONS.validate_json(self._path.read_bytes())
        except FileNotFoundError:
            found = []
        except (OSError, ValidationError) as error:
            raise ConfigurationError(
                f"{self._path} cannot be used: {error}; removing it ends all sessions of pages"
            ) from error
        self._loaded = {session.sha256: session for session in found}
        self._version = version
        return self._loaded

    def _version_of_file(self) -> tuple[int, int]:
        try:
            status = self._path.stat()
        except FileNotFoundError:
            return _NO_VERSION
        except OSError as error:
            raise ConfigurationError(f"{self._path} cannot be used: {error}") from error
        return status.st_mtime_ns, status.st_ino

    @contextmanager
    def _turn(self) -> Iterator[None]:
        try:
            self._writing.acquire()
        except OSError as error:
            raise ConfigurationError(f"{self._path} cannot be written: {error}") from error
        try:
            yield
        finally:
            self._writing.release()

    def _write(self, sessions: list[StoredSession]) -> None:
        temporary = self._path.with_suffix(".new")
        try:
            descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
            with os.fdopen(descriptor, "wb") as file:
                file.write(_SESSIONS.dump_json(sessions, indent=2))
            temporary.replace(self._path)
        except OSError as error:
            raise ConfigurationError(f"{self._path} cannot be written: {error}") from error
        self._loaded = {session.sha256: session for session in sessions}
        self._version = self._version_of_file()


def session_secret(headers: Headers) -> str:
    """Returns the secret of a request's session, "" without one."""
    # Where another service is at the root of the same host, the cookies of both come: first the one
    # of the longer path, which is of this service.
    for cookie in headers.get("cookie", "").split(";"):
        name, _, value = cookie.partition("=")
        if name.strip() == COOKIE:
            return value.strip()
    return ""


def token_of(
    tokens: TokenFile, sessions: SessionFile | None, headers: Headers
) -> StoredToken | None:
    """Returns the token with which a request comes; one that it carries counts before a session.

    Raises:
        ConfigurationError: The file of the tokens or of the sessions cannot be used.
    """
    kind, _, secret = headers.get("authorization", "").partition(" ")
    if kind.lower() == "bearer":
        return tokens.find(secret.strip())
    session = session_secret(headers)
    return sessions.find(session) if session and sessions is not None else None


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
