"""Runs a parser on one input and keeps what goes wrong, once a cause."""

from __future__ import annotations

import hashlib
import json
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzzing.harness import Harness

MAX_CPU_SECONDS = 5.0
"""Of one input; the longest input that a harness makes takes a tenth of a second."""


@dataclass(kw_only=True)
class Session:
    """The findings of the inputs so far.

    Attributes:
        read: Inputs that were not refused.
        causes: Number of inputs by error and place.
        slowest_s: CPU time of the slowest input.
    """

    harness: Harness
    folder: Path
    inputs: int = 0
    read: int = 0
    begun: float = field(default_factory=time.monotonic)
    written: float = 0.0
    slowest_s: float = 0.0
    causes: Counter[str] = field(default_factory=Counter)

    def run(self, data: bytes) -> None:
        """Parses one input; a failure is kept and does not end the session."""
        begun = time.process_time()
        try:
            self.read += self.harness.parse(data)
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException as error:  # whatever it is, it is what is looked for
            self._keep(cause_of(error), data, "".join(traceback.format_exception(error)))
        seconds = time.process_time() - begun
        self.inputs += 1
        if seconds > self.slowest_s:
            self.slowest_s = seconds
            if seconds > MAX_CPU_SECONDS:
                self._keep("slow", data, f"{seconds:.1f} s of CPU time")

    def _keep(self, cause: str, data: bytes, told: str) -> None:
        self.causes[cause] += 1
        path = self.folder / hashlib.sha256(cause.encode()).hexdigest()[:12]
        if not path.exists() or path.stat().st_size > len(data):
            path.write_bytes(data)
            path.with_suffix(".txt").write_text(f"{cause}\n{told}", encoding="utf-8")

    def write_now_and_then(self, path: Path) -> None:
        """Writes the counts as JSON, at once and then at most four times a second."""
        now = time.monotonic()
        if now - self.written >= 0.25:
            self.written = now
            self.write(path)

    def write(self, path: Path) -> None:
        """Writes the counts as JSON."""
        content = {
            "inputs": self.inputs,
            "read": self.read,
            "seconds": time.monotonic() - self.begun,
            "slowest_s": self.slowest_s,
            "causes": dict(self.causes),
        }
        path.write_text(json.dumps(content), encoding="utf-8")


def cause_of(error: BaseException) -> str:
    """Names the type of an error and the innermost place of the product that it passed."""
    place = ""
    for frame in traceback.extract_tb(error.__traceback__):
        if "/drivora_service/" in frame.filename or not place:
            place = f"{frame.filename.rpartition('/drivora_service/')[2]}:{frame.name}"
    return f"{type(error).__name__} in {place}"
