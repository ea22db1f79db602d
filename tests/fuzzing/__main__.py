"""Fuzzes a parser for long: ``python -m tests.fuzzing --parser NAME --inputs N``.

Prints a line a parser: inputs, those of them that were not refused, seconds, inputs a second,
coverage (edges of Drivora's and sumolib's byte code), the slowest input and the findings, whose
inputs are kept. Exits with 1 if there are any.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tests.fuzzing.harnesses import MODULES
from tests.fuzzing.running import run_sessions


def main() -> int:
    """Runs the sessions one after another."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--parser", choices=sorted(MODULES), action="append", default=[])
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--seconds", type=int, default=86_400, help="at most, for each parser")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--max-length",
        type=int,
        default=0,
        metavar="BYTES",
        help="of an input, and of the seeds that are taken: many small ones in less time",
    )
    parser.add_argument("--folder", type=Path, default=Path("fuzzing-findings"))
    options = parser.parse_args()
    print("| parser | inputs | read | seconds | inputs/s | coverage | slowest, s | findings |")
    print("|---|---:|---:|---:|---:|---:|---:|---|")
    has_findings = False
    for name in options.parser or MODULES:
        outcome = run_sessions(
            [name],
            inputs=options.inputs,
            seconds=options.seconds,
            seed=options.seed,
            max_length=options.max_length,
            folder=options.folder,
        )[name]
        has_findings = has_findings or bool(outcome.causes)
        told = "; ".join(f"{cause} ({count})" for cause, count in outcome.causes.items()) or "none"
        rate = outcome.inputs / max(outcome.seconds, 1e-9)
        print(
            f"| {name} | {outcome.inputs} | {outcome.read} | {outcome.seconds:.0f} | {rate:.0f} | "
            f"{outcome.coverage} | {outcome.slowest_s:.2f} | {told} |",
            flush=True,
        )
    return int(has_findings)


if __name__ == "__main__":
    sys.exit(main())
