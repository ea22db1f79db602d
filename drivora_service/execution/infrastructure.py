"""Probes of the storage that every run needs; its faults are not attributed to runs."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import structlog

from drivora_service.errors import StoreDamaged, StoreError
from drivora_service.execution.supervised import SupervisedThread
from drivora_service.fault_log import FaultLog

Probe = Callable[[], None]
"""Tries to write; raises ``OSError`` or ``StoreError`` if it cannot."""

_PROBE_S = 5.0
_RETRY_S = (0.5, 1.0, 2.0, 4.0, 5.0)
"""Seconds between the probes without and with a fault."""

_HANG_S = 30.0
"""Seconds after which a probe that has not returned counts as failed: a network drive hangs."""

_FREE_BYTES = 16 << 20
_FREE_SHARE = 0.25
"""Bytes that must be free on a volume for a trace, or the share of a smaller volume."""

_WRITTEN = bytes(64 << 10)

_log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """The result of a probe.

    Attributes:
        name: Name of the storage, such as ``traces``.
        fault: What is wrong and what to do, "" without a fault.
    """

    name: str
    fault: str


class Infrastructure:
    """Probes the service's storage in a thread and keeps the results. Thread-safe.

    During a fault no run is started, and runs that fail because of it are not counted as failed.
    """

    def __init__(
        self, probes: Mapping[str, Probe], *, on_fatal: Callable[[str], None] = lambda _: None
    ) -> None:
        """Creates the record of the probes, with no fault; :meth:`start` starts the thread.

        Args:
            probes: Probes by the name under which they are reported.
            on_fatal: Called with the reason for which the thread has given up.
        """
        self._probes = dict(probes)
        self._found = dict.fromkeys(self._probes, "")
        self._lasting: dict[str, str] = {}
        self._on_change: Callable[[], None] = lambda: None
        self._faults = FaultLog(_log)
        self._probing = threading.Lock()
        self._begun_at: float | None = None
        self._failures = 0
        self._fault_since: float | None = None
        self._again = threading.Event()
        self._thread = SupervisedThread("infrastructure", self._turn, on_fatal=on_fatal)

    @property
    def fault(self) -> str:
        """What is wrong and what to do, "" without a fault; from the last results."""
        return "; ".join(f"{c.name}: {c.fault}" for c in self.conditions() if c.fault)

    def fault_for(self, seconds: float) -> str:
        """Returns the fault if there has been one without a break for some seconds, else "".

        One that does not end is returned at once.
        """
        since = self._fault_since
        begun = self._begun_at
        if since is None and begun is not None:
            # A probe that hangs.
            since = begun
        waits = since is None or time.monotonic() - since < seconds
        if waits and not self._lasting:
            return ""
        return self.fault

    def conditions(self) -> tuple[Condition, ...]:
        """Returns the last result of each probe."""
        begun = self._begun_at
        silent = begun is not None and time.monotonic() - begun > _HANG_S
        hung = f"writing has not ended for {_HANG_S:g} s; look at its disk" if silent else ""
        return tuple(
            Condition(name=name, fault=self._lasting.get(name, "") or fault or hung)
            for name, fault in self._found.items()
        )

    def confirm_now(self) -> str:
        """Probes at once, in the calling thread.

        Returns:
            The fault; "" if everything can be written.
        """
        if self._probe():
            # The thread shall probe again soon, and not only at its next turn.
            self._again.set()
        return self.fault

    def note_damage(self, name: str, fault: str) -> None:
        """Keeps a fault that does not end before the process does; written to the log once.

        Args:
            name: Name of the storage.
            fault: What is wrong and what to do.
        """
        self._lasting[name] = fault
        _log.error(f"{name}_damaged", reason=fault)
        self._on_change()

    def start(self, *, on_change: Callable[[], None]) -> None:
        """Starts the thread that probes.

        Args:
            on_change: Called, from any probing thread, when a fault begins or ends.
        """
        self._on_change = on_change
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread; one that hangs in a probe is left behind."""
        self._thread.stop()
        self._again.set()
        self._thread.join(1.0)

    def _probe(self) -> bool:
        """Runs every probe; returns whether a fault began or ended."""
        with self._probing:
            before = any(self._found.values())
            self._begun_at = time.monotonic()
            try:
                for name, probe in self._probes.items():
                    self._found[name] = self._try(name, probe)
            finally:
                self._begun_at = None
            found = any(self._found.values())
            self._failures = self._failures + 1 if found else 0
            if not found:
                self._fault_since = None
            elif self._fault_since is None:
                self._fault_since = time.monotonic()
        if found != before:
            self._on_change()
        return found != before

    def _turn(self) -> None:
        self._again.clear()
        self._probe()
        failures = self._failures
        pause = _RETRY_S[min(failures, len(_RETRY_S)) - 1] if failures else _PROBE_S
        self._again.wait(pause)

    def _try(self, name: str, probe: Probe) -> str:
        try:
            probe()
        except StoreDamaged as error:
            # Its first finder has called note_damage().
            return str(error)
        except (OSError, StoreError) as error:
            self._faults.error(f"{name}_not_writable", reason=str(error))
            return str(error)
        self._faults.over(f"{name}_not_writable", f"{name}_writable_again")
        return ""


def folder_probe(folder: Path) -> Probe:
    """Returns a probe that writes a file into a folder and makes the folder if it is missing."""

    def probe() -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            volume = os.statvfs(folder)
            free = volume.f_bavail * volume.f_frsize
            needed = min(_FREE_BYTES, int(_FREE_SHARE * volume.f_blocks * volume.f_frsize))
            path = folder / f".probe.{os.getpid()}"
            try:
                path.write_bytes(_WRITTEN)
            finally:
                path.unlink(missing_ok=True)
        except OSError as error:
            raise OSError(
                f"nothing can be written to {folder}: {error.strerror or error}; make it a folder "
                "that can be written to, with free space"
            ) from error
        if free < needed:
            raise OSError(
                f"only {free >> 10} KiB are free for {folder}; a run needs {needed >> 10} KiB: "
                "`drivora store prune` removes old runs"
            )

    return probe
