"""The suite: all measurements of time, written as one JSON and one page.

python -m benchmarks                                  # all, about half an hour
python -m benchmarks --networks MAPS --routes FILE    # Town01 and Town04, too
python -m benchmarks --short                          # shows that everything runs; for CI
python -m benchmarks --only peers api                 # some
python -m benchmarks compare ONE.json OTHER.json
python -m benchmarks page RESULT.json                 # writes the page of a result again
python -m benchmarks schema                           # the JSON Schema of a result
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.suite.comparing import compare, table
from benchmarks.suite.machine import this_machine
from benchmarks.suite.measurement import Plan, perform
from benchmarks.suite.page import page
from benchmarks.suite.result import ADAPTER, ResultError, SuiteResult, read_result, write_result

_ROOT = Path(__file__).parent
_RESULT = _ROOT / "results" / "benchmarks.json"
_PAGE = _ROOT.parent / "docs" / "reference" / "benchmarks.md"
_CACHE = Path("~/.cache/drivora-benchmarks")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; returns its exit code."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    commands = {"compare": _compare, "page": _page, "schema": _schema}
    try:
        if given and given[0] in commands:
            return commands[given[0]](given[1:])
        return _measure(given)
    except ResultError as error:
        print(error, file=sys.stderr)
        return 2


def _compare(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks compare")
    parser.add_argument("one", type=Path)
    parser.add_argument("other", type=Path)
    options = parser.parse_args(arguments)
    print(table(compare(read_result(options.one), read_result(options.other))), end="")
    return 0


def _page(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks page")
    parser.add_argument("result", type=Path, nargs="?", default=_RESULT)
    parser.add_argument("--out", type=Path, default=_PAGE)
    options = parser.parse_args(arguments)
    options.out.write_text(page(read_result(options.result)))
    return 0


def _schema(arguments: Sequence[str]) -> int:
    argparse.ArgumentParser(prog="python -m benchmarks schema").parse_args(arguments)
    print(json.dumps(ADAPTER.json_schema(), indent=2))
    return 0


def _measure(arguments: Sequence[str]) -> int:
    # Imported here: they need most of the package, which the other commands do not.
    from benchmarks.suite.campaign_throughput import SHORT_SIMULATIONS, least_simulations
    from benchmarks.suite.measurements import MEASUREMENTS

    names = [measurement.name for measurement in MEASUREMENTS]
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--short", action="store_true", help="only show that everything runs")
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME")
    parser.add_argument("--rounds", type=int, help="default 5; short form 1")
    parser.add_argument(
        "--simulations",
        type=int,
        help=f"of each campaign, default 400; short form {SHORT_SIMULATIONS}",
    )
    parser.add_argument("--networks", type=Path, help="folder of NAME.net.xml, with Town01, Town04")
    parser.add_argument("--routes", type=Path, help="Leaderboard 1.0 route file of these towns")
    parser.add_argument("--cache", type=Path, default=_CACHE, help="for environments of peers")
    parser.add_argument("--out", type=Path, help="result file; the short form's is in build/")
    parser.add_argument("--page", type=Path, help="page; the short form writes none by default")
    options = parser.parse_args(arguments)
    least = least_simulations(short=options.short)
    if options.simulations is not None and options.simulations < least:
        parser.error(f"--simulations: at least {least}, as the first are not counted")
    out: Path = options.out or (
        _ROOT.parent / "build" / "benchmarks-short.json" if options.short else _RESULT
    )
    partly = options.short or options.only != names
    written: Path | None = options.page or (None if partly else _PAGE)
    machine, begun = this_machine(), datetime.now(UTC).isoformat(timespec="seconds")
    sections = []
    for measurement in MEASUREMENTS:
        if measurement.name not in options.only:
            continue
        print(f"{measurement.title} …", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            plan = Plan(
                short=options.short,
                rounds=options.rounds or (1 if options.short else 5),
                simulations=options.simulations or (SHORT_SIMULATIONS if options.short else 400),
                networks=options.networks,
                routes=options.routes,
                cache=options.cache.expanduser(),
                folder=Path(folder),
            )
            sections.append(perform(measurement, plan))
        for series in sections[-1].series:
            quantity = series.quantity
            print(
                f"  {quantity.case + ': ' + quantity.name:<62} {series.median:10.3f} "
                f"{quantity.unit} ({series.low:.3f} to {series.high:.3f})",
                flush=True,
            )
        for remark in sections[-1].remarks:
            print(f"  Left out: {remark}", flush=True)
        # After each, so that a failure loses one measurement only.
        result = SuiteResult(
            begun=begun,
            short=options.short,
            command=tuple(_without_folder(one) for one in arguments),
            machine=machine,
            sections=tuple(sections),
        )
        write_result(result, out)
        if written is not None:
            written.write_text(page(result))
    print(f"Written: {out}" + ("" if written is None else f", {written}"))
    return 0


def _without_folder(argument: str) -> str:
    """Returns an argument; of an absolute path its last part, as folders are of this machine."""
    return Path(argument).name if Path(argument).is_absolute() else argument


if __name__ == "__main__":
    sys.exit(main())
