"""API tokens: random, shown once, kept as hashes in a file that only the owner may read.

The tokens have 256 random bits, so a plain SHA-256 is enough at rest: there is nothing to guess.
"""

from __future__ import annotations

import hashlib
import os
import secrets
import threading
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import IntEnum
from pathlib import Path

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from drivora_service.errors import ConfigurationError, UnknownName
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
    mtime_ns: int
    by_hash: dict[str, StoredToken]


class TokenFile:
    """The tokens of one installation; changes on disk count from the next request on."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lock = threading.Lock()
        self._loaded = _Loaded(mtime_ns=-1, by_hash={})

    def all(self) -> tuple[StoredToken, ...]:
        """Returns all tokens, without their secrets."""
        return tuple(self._current().values())

    def create(self, name: str, scope: Scope) -> str:
        """Adds a new token and returns its secret, which is not kept.

        Raises:
            ConfigurationError: The name is taken, or none that can be shown.
        """
        if fault := describe_name_fault(name):
            raise ConfigurationError(f"the name of a token: {fault}")
        tokens = self.all()
        if any(token.name == name for token in tokens):
            raise ConfigurationError(f"there is a token named {name!r} already; revoke it first")
        secret = _PREFIX + secrets.token_urlsafe(32)
        stored = StoredToken(
            name=name, scope=scope, sha256=_hash(secret), created=datetime.now(UTC)
        )
        self._write([*tokens, stored])
        return secret

    def revoke(self, name: str) -> None:
        """Removes a token.

        Raises:
            UnknownName: There is none of that name.
        """
        tokens = self.all()
        rest = [token for token in tokens if token.name != name]
        if len(rest) == len(tokens):
            raise UnknownName("token", name, tuple(token.name for token in tokens))
        self._write(rest)

    def find(self, secret: str) -> StoredToken | None:
        """Returns the token that a request carries, or ``None`` if it is not one of ours."""
        return self._current().get(_hash(secret))

    def by_hash(self, sha256: str) -> StoredToken | None:
        """Returns the token of a hash, or ``None`` if there is none."""
        return self._current().get(sha256)

    def _current(self) -> dict[str, StoredToken]:
        try:
            mtime_ns = self._path.stat().st_mtime_ns
        except FileNotFoundError:
            return {}
        with self._lock:
            if mtime_ns != self._loaded.mtime_ns:
                try:
                    tokens = _TOKENS.validate_json(self._path.read_bytes())
                except (OSError, ValidationError) as error:
                    raise ConfigurationError(f"{self._path} cannot be used: {error}") from error
                self._loaded = _Loaded(
                    mtime_ns=mtime_ns, by_hash={token.sha256: token for token in tokens}
                )
            return self._loaded.by_hash

    def _write(self, tokens: list[StoredToken]) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        temporary = self._path.with_suffix(".new")
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        with os.fdopen(descriptor, "wb") as file:
            file.write(_TOKENS.dump_json(tokens, indent=2))
        temporary.replace(self._path)


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
