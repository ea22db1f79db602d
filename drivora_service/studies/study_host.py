"""The host protocol: runs studies for the API, on a service or in a command."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from drivora_service.store.database import Transaction


class StudyHost(Protocol):
    """Accepts studies and runs their campaigns until they end or pause."""

    def open(self, transaction: Transaction, study_id: str, campaign_ids: Sequence[str]) -> None:
        """Accepts a new study, in the transaction that stores it."""
        ...

    def resume(self, study_id: str) -> None:
        """Accepts a study whose campaigns do not run.

        Raises:
            UnknownName: There is no such study.
            Conflict: All its campaigns are over, or a process works on it.
        """
        ...

    def has_process(self, study_id: str) -> bool:
        """Returns whether the process of a command runs a study."""
        ...

    def wake(self) -> None:
        """Starts accepted studies, or follows a request; called after the transaction."""
        ...
