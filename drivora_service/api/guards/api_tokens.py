"""API tokens: random, shown once, kept as hashes in a file that only the owner may read.

The tokens have 256 random bits, so a plain SHA-256 is enough at rest: there is nothing to guess.
"""

from __future__ import annotations

import hashlib
import secrets
import threading
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import IntEnum
from pathlib import Path

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from drivora_service.api.guards.secret_files import (
    FileVersion,
    read_secret_file,
    secret_file,
    write_secret_file,
)
from drivora_service.errors import ConfigurationError, CredentialsUnusable, UnknownName
from drivora_service.given_names import describe_name_fault

_PREFIX = "drv_"


class Scope(IntEnum):
    """The scope of a token; a higher scope includes the lower ones."""

    READ = 1
    SUBMIT = 2
    ADMIN = 3


class StoredToken(BaseModel):
    """A token at rest."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    scope: Scope
    sha256: str
    created: datetime


_TOKENS = TypeAdapter(list[StoredToken])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Loaded:
    """What a version of the file says.

    Attributes:
        version: That version; ``None``: the file does not exist.
        by_hash: Its tokens.
        fault: Why it cannot be used and what to do, "" if it can.
    """

    version: FileVersion | None
    by_hash: dict[str, StoredToken]
    fault: str = ""


class TokenFile:
    """The tokens of one installation; changes on disk count from the next request on.

    A service needs tokens once the file exists, even if all its tokens were revoked, and until it
    is started again even if the file is removed: only an operator who removes it and starts the
    service again opens it.
    """

    def __init__(self, path: Path, *, always_needed: bool = True) -> None:
        """Reads nothing yet.

        Args:
            path: The file, which its owner only may read.
            always_needed: Whether a token is needed also where the file does not exist.
        """
        self._path, self._always_needed = path, always_needed
        self._lock = threading.Lock()
        self._loaded = _Loaded(version=None, by_hash={})
        self._has_existed = False

    @property
    def are_needed(self) -> bool:
        """Whether a request needs a token."""
        return self._always_needed or self._has_existed or self._current().version is not None

    @property
    def fault(self) -> str:
        """Why the tokens cannot be used and what to do, "" if they can."""
        return self._current().fault

    def all(self) -> tuple[StoredToken, ...]:
        """Returns all tokens, without their secrets.

        Raises:
            CredentialsUnusable: The file cannot be read.
        """
        return tuple(self._tokens().values())

    def create(self, name: str, scope: Scope) -> str:
        """Adds a new token and returns its secret, which is not kept.

        Raises:
            ConfigurationError: The name is taken, or none that can be shown.
            CredentialsUnusable: The file cannot be read.
            StoreError: The file cannot be written; it is as it was.
        """
        if fault := describe_name_fault(name):
            raise ConfigurationError(f"the name of a token: {fault}")
        with secret_file(self._path):
            tokens = self.all()
            if any(token.name == name for token in tokens):
                raise ConfigurationError(
                    f"there is a token named {name!r} already; revoke it first"
                )
            secret = _PREFIX + secrets.token_urlsafe(32)
            stored = StoredToken(
                name=name, scope=scope, sha256=_hash(secret), created=datetime.now(UTC)
            )
            self._write([*tokens, stored])
        return secret

    def revoke(self, name: str) -> None:
        """Removes a token.

        Raises:
            CredentialsUnusable: The file cannot be read.
            StoreError: The file cannot be written; it is as it was.
            UnknownName: There is none of that name.
        """
        with secret_file(self._path):
            tokens = self.all()
            rest = [token for token in tokens if token.name != name]
            if len(rest) == len(tokens):
                raise UnknownName("token", name, tuple(token.name for token in tokens))
            self._write(rest)

    def find(self, secret: str) -> StoredToken | None:
        """Returns the token that a request carries, or ``None`` if it is not one of ours.

        Raises:
            CredentialsUnusable: The file cannot be read.
        """
        return self._tokens().get(_hash(secret))

    def by_hash(self, sha256: str) -> StoredToken | None:
        """Returns the token of a hash, or ``None`` if there is none.

        Raises:
            CredentialsUnusable: The file cannot be read.
        """
        return self._tokens().get(sha256)

    def _tokens(self) -> dict[str, StoredToken]:
        loaded = self._current()
        if loaded.fault:
            raise CredentialsUnusable(loaded.fault)
        return loaded.by_hash

    def _current(self) -> _Loaded:
        try:
            version = FileVersion.of(self._path)
        except OSError as error:
            return _Loaded(
                version=FileVersion.UNKNOWN, by_hash={}, fault=_unreadable(self._path, error)
            )
        with self._lock:
            # One that could not be read is tried again: its mode is no part of its version.
            if version != self._loaded.version or self._loaded.fault:
                self._loaded = _read(self._path, version)
            if self._loaded.version is not None:
                self._has_existed = True
            return self._loaded

    def _write(self, tokens: list[StoredToken]) -> None:
        write_secret_file(self._path, _TOKENS.dump_json(tokens, indent=2))


def _read(path: Path, version: FileVersion | None) -> _Loaded:
    if version is None:
        return _Loaded(version=None, by_hash={})
    try:
        tokens = _TOKENS.validate_json(read_secret_file(path))
    except FileNotFoundError:
        return _Loaded(version=None, by_hash={})
    except OSError as error:
        return _Loaded(version=version, by_hash={}, fault=_unreadable(path, error))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        found = f"{place}: {first['msg']}" if place else first["msg"]
        return _Loaded(
            version=version,
            by_hash={},
            fault=f"{path} cannot be used: it is no list of API tokens ({found}). Restore it from "
            "a backup, or move it away and make new tokens with `drivora tokens create NAME`",
        )
    return _Loaded(version=version, by_hash={token.sha256: token for token in tokens})


def _unreadable(path: Path, error: OSError) -> str:
    return (
        f"{path} cannot be used: {error.strerror or error}. It must be a file that the account of "
        "the service can read; `drivora tokens` is for that account, too"
    )


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
