"""Makes the smoke suite: ``python -m benchmarks.smoke_suite --work FOLDER --to FOLDER``.

Steps that have ended are kept in the work folder, and a second command leaves them out; one that
was interrupted is removed by hand. Without ``--to`` nothing of the checkout is changed.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.smoke_suite.choosing import candidates, choose, smaller, table
from benchmarks.smoke_suite.searching import drive, export, make_baseline, minimize, search
from benchmarks.smoke_suite.writing import write_suite

SIZE = 100
_TO_MINIMIZE = 150
"""Scenarios that are minimised: more than are wanted, as the smallest form of one may have lost
what told ADSs apart."""


def main() -> int:
    """Runs the search, the panel and the choice; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True, help="folder of the intermediate files")
    parser.add_argument("--budget", type=int, default=500, help="simulations of a minimisation")
    parser.add_argument("--to", type=Path, help="folder of the suite to write")
    options = parser.parse_args()
    work: Path = options.work
    work.mkdir(parents=True, exist_ok=True)
    export(work, search(work))
    drive(work, "pool")
    pool = list(candidates(work, "pool"))
    picked = choose(pool, size=_TO_MINIMIZE)
    minimize(work, {one.name: one.followed for one in picked}, budget=options.budget)
    drive(work, "small")
    chosen = choose(smaller(pool, list(candidates(work, "small"))), size=SIZE)
    print(table(chosen))
    if options.to is not None:
        write_suite(options.to, chosen)
        make_baseline(work, options.to)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
