"""One attempt at a run: its slot, its times and its report."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from drivora_service.runs.candidate import Candidate
from drivora_service.runs.run_report import RunReport


@dataclass(frozen=True, slots=True, kw_only=True)
class AttemptEnd:
    """The end of an attempt. Its report is that of the run unless the attempt is repeated.

    Attributes:
        worker: Name of the slot.
        started: When the slot took the run, UTC.
        ended: When the slot saw its end, UTC.
        attempt: Its number; 0 for the one that is open, whichever that is.
        signal: Name of the signal that ended the worker process, such as ``SIGSEGV``, or "".
        candidate: What the worker made of the spec's genes; ``None`` if it made nothing of them, or
            there are none.
    """

    report: RunReport
    worker: str
    started: datetime
    ended: datetime
    attempt: int = 0
    signal: str = ""
    candidate: Candidate | None = None
