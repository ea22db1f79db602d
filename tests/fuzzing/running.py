"""Starts a session in a process of its own and reads what came of it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_REPOSITORY = Path(__file__).resolve().parents[2]
_COVERAGE = re.compile(r" cov: (\d+) ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The result of a session.

    Attributes:
        read: Inputs that were not refused.
        seconds: Wall time, without the start of the process.
        coverage: Edges of the instrumented byte code that some input took.
        slowest_s: CPU time of the slowest input.
        causes: Number of inputs by error and place.
    """

    inputs: int
    read: int
    seconds: float
    coverage: int
    slowest_s: float
    causes: Mapping[str, int]


def run_session(
    name: str, *, inputs: int, seconds: int, seed: int, folder: Path, max_length: int = 0
) -> Outcome:
    """Runs a parser on that many inputs, or for that many seconds.

    Args:
        name: Of the harness.
        inputs: At most.
        seconds: At most.
        seed: Of the draws; the same inputs follow from it as long as the parser stays as it is.
        folder: Findings are kept there, a file a cause with its traceback beside it.
        max_length: Bytes of an input, and of the seeds that are taken; 0: as the harness says.
    """
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "session.log"
    words = [name, str(inputs), str(seconds), str(seed), str(max_length)]
    begun = time.monotonic()
    with log.open("wb") as output:
        ended = subprocess.run(
            [sys.executable, "-m", "tests.fuzzing.session", *words, str(folder.resolve())],
            cwd=_REPOSITORY,
            stdout=output,
            stderr=output,
            check=False,
        )
    text = log.read_text(encoding="utf-8", errors="replace")
    counts_file = folder / "counts.json"
    counts = json.loads(counts_file.read_text()) if counts_file.exists() else {}
    causes = dict(counts.get("causes", {}))
    if ended.returncode:
        # A crash of native code, or libFuzzer's own limit on the time of an input.
        last = text.strip().splitlines()[-1:] or ["nothing was printed"]
        causes[f"the process ended with {ended.returncode}: {last[0][:200]}; see {log}"] = 1
    covered = _COVERAGE.findall(text)
    return Outcome(
        inputs=counts.get("inputs", 0),
        read=counts.get("read", 0),
        seconds=counts.get("seconds", time.monotonic() - begun),
        coverage=int(covered[-1]) if covered else 0,
        slowest_s=counts.get("slowest_s", 0.0),
        causes=causes,
    )
