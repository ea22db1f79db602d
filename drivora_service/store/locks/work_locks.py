"""Locks on pieces of long work, each done by one process at a time.

They are released when their process dies, however it dies, on whichever machine: the next process
need not wait until it is taken for dead. On PostgreSQL they are session locks of one connection
(``postgresql_work_locks``), on SQLite locks of files beside the database (``file_work_locks``).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from drivora_service.errors import Conflict


class WorkKind(StrEnum):
    """Kinds of work that one process does at a time."""

    CAMPAIGN = "campaign"
    STUDY = "study"
    MINIMIZATION = "minimisation"
    HOUSEKEEPING = "housekeeping"
    SERVER = "server"
    """A server; not work, but known in the same way."""
    COMMAND = "command"
    """A command with runs of its own; known like a server."""


@dataclass(frozen=True, slots=True)
class LongWork:
    """A piece of work.

    Attributes:
        kind: What it is.
        id: Its id.
    """

    kind: WorkKind
    id: str

    @classmethod
    def campaign(cls, campaign_id: str) -> LongWork:
        """Returns the work on a campaign."""
        return cls(WorkKind.CAMPAIGN, campaign_id)

    @classmethod
    def server(cls, owner_id: str) -> LongWork:
        """Returns what a server holds for as long as it lives."""
        return cls(WorkKind.SERVER, owner_id)

    @classmethod
    def command(cls, owner_id: str) -> LongWork:
        """Returns what a command with runs holds for as long as it lives."""
        return cls(WorkKind.COMMAND, owner_id)

    @classmethod
    def minimization(cls, minimization_id: str) -> LongWork:
        """Returns the work of a service on a minimisation."""
        return cls(WorkKind.MINIMIZATION, minimization_id)

    @classmethod
    def study(cls, study_id: str) -> LongWork:
        """Returns the work of a command on a study."""
        return cls(WorkKind.STUDY, study_id)

    def __str__(self) -> str:
        return f"{self.kind} {self.id}"


class HeldWork(Protocol):
    """A lock that this process holds."""

    def release(self) -> None:
        """Releases the lock."""


class WorkLocks(Protocol):
    """The locks of one database."""

    def hold(self, work: LongWork) -> HeldWork:
        """Locks a piece of work for this process.

        Raises:
            Conflict: A process does it already.
            StoreError: Nothing can be locked.
        """

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work.

        Raises:
            StoreError: It cannot be known.
        """

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind.

        Raises:
            StoreError: It cannot be known.
        """

    def holders(self, kind: WorkKind) -> tuple[str, ...]:
        """Returns the names of the processes that do work of a kind.

        Raises:
            StoreError: They cannot be known.
        """

    def forget(self, work: LongWork) -> None:
        """Removes what a dead process has left of a lock that none will take again."""

    def keep(self) -> None:
        """Takes the held locks again if they were lost with their connection.

        Locks that other processes have meanwhile are tried again with each call.

        Raises:
            StoreError: The database cannot be used now.
        """

    def close(self) -> None:
        """Releases all locks."""


def refusal(work: LongWork, holder: str) -> str:
    """Returns the message of the refusal of work that another process does."""
    return f"{holder} is running {work} already"


def refuse_while_used(locks: WorkLocks) -> None:
    """Refuses to migrate a database of which a process on any machine has the older schema.

    Commands that only read hold no lock, and prevent nothing.

    Raises:
        Conflict: A server or a command works on it; the message names the processes.
        StoreError: It cannot be known.
    """
    works: dict[str, list[str]] = {}
    for kind in WorkKind:
        for holder in locks.holders(kind):
            works.setdefault(holder, []).append(kind)
    if works:
        found = ", ".join(f"{holder} ({', '.join(kinds)})" for holder, kinds in works.items())
        raise Conflict(
            "this version of Drivora would migrate the database, on which processes of an older "
            f"version work: {found}; stop them, or wait for their end, then try again"
        )
