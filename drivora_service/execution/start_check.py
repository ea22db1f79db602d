"""The check of a SQLite file before a service uses it, which goes on beside the service."""

from __future__ import annotations

import threading
from pathlib import Path

import structlog

from drivora_service.errors import StoreDamaged
from drivora_service.store.engine.damage_latch import DamageLatch
from drivora_service.store.engine.integrity_check import IntegrityCheck

START_CHECK_S = 10.0
"""Seconds for which a start waits for the check. A store of 300,000 runs (1.6 GB) takes 3 to 7 s
from memory and 20 to 50 s from a slow disk."""

_STOP_S = 5.0

_log = structlog.get_logger(__name__)


class StartCheck:
    """Checks a database while the service starts, and the rest of a large one after that."""

    def __init__(self, file: Path | None, *, seconds: float = START_CHECK_S) -> None:
        """Checks the file for a limited time.

        Args:
            file: File of an SQLite database, which need not exist; ``None``: it is none.
            seconds: Time after which the service starts.

        Raises:
            StoreDamaged: It is damaged.
        """
        exists = file is not None and file.is_file() and file.stat().st_size > 0
        self._check = IntegrityCheck(file) if file is not None and exists else None
        self._thread: threading.Thread | None = None
        if self._check is not None:
            self._check.run(seconds)

    def start(self, damage: DamageLatch) -> None:
        """Checks the tables that are left, in a thread.

        Args:
            damage: Keeps a damage that is found.
        """
        if self._check is None or not self._check.unchecked:
            return
        _log.info("integrity_check_goes_on", unchecked=list(self._check.unchecked))
        self._thread = threading.Thread(
            target=self._finish, args=(self._check, damage), name="integrity", daemon=True
        )
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread."""
        if self._check is not None and self._thread is not None:
            self._check.stop()
            self._thread.join(_STOP_S)

    def _finish(self, check: IntegrityCheck, damage: DamageLatch) -> None:
        try:
            if check.run():
                _log.info("integrity_checked")
        except StoreDamaged as error:
            damage.note(str(error))
