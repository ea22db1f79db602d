"""Starts sessions in processes of their own and reads what came of them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_REPOSITORY = Path(__file__).resolve().parents[2]
_COVERAGE = re.compile(r" cov: (\d+) ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The result of a session.

    Attributes:
        read: Inputs that were not refused.
        seconds: Wall time, of the inputs.
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


def run_sessions(
    names: Sequence[str], *, inputs: int, seconds: int, seed: int, folder: Path, max_length: int = 0
) -> dict[str, Outcome]:
    """Runs parsers one after another on that many inputs each, or for that many seconds.

    Args:
        names: Of the harnesses.
        inputs: At most.
        seconds: At most.
        seed: Of the draws; the same inputs follow from it as long as the parser stays as it is.
        folder: Findings are kept there, in a folder a parser, a file a cause with its traceback
            beside it.
        max_length: Bytes of an input, and of the seeds that are taken; 0: as the harness says.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        for file in ("counts.json", "ended", "session.log"):
            (folder / name / file).unlink(missing_ok=True)
    log = folder / "sessions.log"
    words = [str(inputs), str(seconds), str(seed), str(max_length)]
    with log.open("wb") as output:
        ended = subprocess.run(
            [sys.executable, "-m", "tests.fuzzing.session", *words, str(folder.resolve()), *names],
            cwd=_REPOSITORY,
            stdout=output,
            stderr=output,
            check=False,
        )
    return {name: _outcome(folder / name, ended.returncode, log) for name in names}


def _outcome(folder: Path, code: int, log: Path) -> Outcome:
    """Reads the result of a session.

    Args:
        folder: Its own.
        code: What the process ended with that was to begin it.
        log: The output of that process.
    """
    ended = folder / "ended"
    if ended.exists():
        code, log = int(ended.read_text()), folder / "session.log"
    text = log.read_text(encoding="utf-8", errors="replace")
    counts_file = folder / "counts.json"
    counts = json.loads(counts_file.read_text()) if counts_file.exists() else {}
    causes = dict(counts.get("causes", {}))
    if code or not ended.exists():
        # A crash of native code, or libFuzzer's own limit on the time of an input.
        last = text.strip().splitlines()[-1:] or ["nothing was printed"]
        causes[f"the process ended with {code}: {last[0][:200]}; see {log}"] = 1
    covered = _COVERAGE.findall(text)
    return Outcome(
        inputs=counts.get("inputs", 0),
        read=counts.get("read", 0),
        seconds=counts.get("seconds", 0.0),
        coverage=int(covered[-1]) if covered else 0,
        slowest_s=counts.get("slowest_s", 0.0),
        causes=causes,
    )
