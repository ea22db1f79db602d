"""The stability of a service under load: many short runs, one in fifty with a hostile agent.

A real server with two workers does batches of short drives; hostile agents hang, die, flood the
log, leave processes behind and turn against their worker. After each batch its runs are judged
(lost, counted twice, blamed wrongly), and memory, descriptors, processes, threads and files are
read from /proc. Whether the service has become slower is measured at the end, against a fresh one
beside it: both do batches of good runs in turn, so that whatever else the machine does meets both.

    python -m benchmarks.soak --runs 20000 --out benchmarks/results/soak.md
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil

from tests.faults import processes
from tests.faults.invariants import Hashes, Judgement, judge, undisturbed
from tests.faults.service_under_test import Service
from tests.faults.work import KINDS, Run, among

HOSTILE = (
    *("hanger", "burner", "child-hanger", "segfault", "exiter", "self-killer", "self-stopper"),
    *("daemoniser", "child-eater", "flooder", "garbage", "half-message", "huge-message"),
    *("pickler", "forger", "truncater", "scribbler", "log-replacer"),
)
SHARE = 0.02
DRIVER = "idm"
"""Drives the good runs: it does not wait, so that the machine is busy."""

_MIB = 1 << 20
_PATIENCE_S = 1800.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """The service after some runs.

    Attributes:
        runs: Runs that have ended.
        seconds: Since the first was posted.
        server_mib: Resident memory of the server.
        fork_server_mib: The same of the fork server.
        workers_mib: The same of the largest worker.
        descriptors: That the server has open.
        processes: Of the service, the server included.
        threads: Of the server.
        files: In the folder of the workers.
        logs_mib: Size of these files.
        database_mib: Size of the database with its log of changes.
        cpu_s: Seconds of processor time of the whole service.
    """

    runs: int
    seconds: float
    server_mib: float
    fork_server_mib: float
    workers_mib: float
    descriptors: int
    processes: int
    threads: int
    files: int
    logs_mib: float
    database_mib: float
    cpu_s: float


FITTED = (
    *("server_mib", "fork_server_mib", "workers_mib", "descriptors", "processes", "threads"),
    *("files", "logs_mib", "database_mib"),
)


def sample(service: Service, runs: int, seconds: float) -> Sample:
    """Reads the resources of the service."""
    tree = processes.tree(service.pid)
    server = tree[0]
    source = service.fork_server()
    files = [path for path in (service.data / "workers").iterdir() if path.is_file()]
    return Sample(
        runs=runs,
        seconds=seconds,
        server_mib=_resident(server),
        fork_server_mib=_resident(source),
        workers_mib=max(
            (_resident(p) for p in processes.workers(service.data / "workers")), default=0.0
        ),
        descriptors=server.num_fds(),
        processes=len(tree),
        threads=server.num_threads(),
        files=len(files),
        logs_mib=sum(_size(path) for path in files) / _MIB,
        database_mib=sum(_size(p) for p in service.data.glob("drivora.sqlite3*")) / _MIB,
        cpu_s=sum(_cpu_s(process) for process in tree),
    )


def _resident(process: psutil.Process) -> float:
    with contextlib.suppress(psutil.Error):
        return float(process.memory_info().rss) / _MIB
    return 0.0


def _cpu_s(process: psutil.Process) -> float:
    """Returns the processor time of a process and of its reaped children."""
    with contextlib.suppress(psutil.Error):
        times = process.cpu_times()
        return float(times.user + times.system + times.children_user + times.children_system)
    return 0.0


def _size(path: Path) -> int:
    with contextlib.suppress(OSError):
        return path.lstat().st_size
    return 0


def batch(number: int, size: int) -> list[Run]:
    """Returns the runs of a batch; each has other hostile agents, in turn."""
    count = round(size * SHARE)
    first = number * count
    hostile = list(itertools.islice(itertools.cycle(HOSTILE), first, first + count))
    good = [Run(agent=DRIVER, kind=n % KINDS, seed=n % KINDS) for n in range(size - count)]
    return among(good, hostile, seed=number)


def soak(
    service: Service, runs: int, size: int, hashes: Hashes
) -> tuple[list[Sample], list[Judgement]]:
    """Posts batches, each when few runs of the previous one are left, and checks them."""
    samples: list[Sample] = []
    judgements: list[Judgement] = []
    begun = time.monotonic()
    work = service.post(batch(0, size))
    for number in range(runs // size):
        service.wait_until_ended(work, size - size // 10, seconds=_PATIENCE_S)
        following = service.post(batch(number + 1, size))
        (service.evidence / "target").write_text(next(iter(following.runs)))
        judgements.append(judge(service, work, hashes, seconds=_PATIENCE_S))
        samples.append(sample(service, (number + 1) * size, time.monotonic() - begun))
        print(samples[-1], judgements[-1].notes, flush=True)
        work = following
    service.wait_until_ended(work, size, seconds=_PATIENCE_S)
    return samples, judgements


@dataclass(frozen=True, slots=True, kw_only=True)
class Round:
    """The cost of a batch of good runs.

    Attributes:
        seconds: From posting it to its end.
        cpu_s: Processor time of the whole service.
        server_cpu_s: Of its server alone.
    """

    seconds: float
    cpu_s: float
    server_cpu_s: float


def in_turn(services: Sequence[Service], *, rounds: int, size: int) -> list[list[Round]]:
    """Lets services run batches of good runs in turn; returns the costs, service by service.

    Args:
        services: Ready, and with nothing to do.
        rounds: Batches of each; one more before them is not counted.
        size: Runs of a batch.
    """
    work = [Run(agent=DRIVER, kind=n % KINDS, seed=n % KINDS) for n in range(size)]
    found: list[list[Round]] = [[] for _ in services]
    for number in range(rounds + 1):
        for service, its in zip(services, found, strict=True):
            before, begun = _measure_cpu(service), time.monotonic()
            service.wait_until_ended(service.post(work), size, seconds=_PATIENCE_S)
            seconds, after = time.monotonic() - begun, _measure_cpu(service)
            if number:
                cpu_s, server_cpu_s = (b - a for a, b in zip(before, after, strict=True))
                its.append(Round(seconds=seconds, cpu_s=cpu_s, server_cpu_s=server_cpu_s))
    return found


def _measure_cpu(service: Service) -> tuple[float, float]:
    tree = processes.tree(service.pid)
    return sum(_cpu_s(process) for process in tree), _cpu_s(tree[0])


def against_fresh(old: Sequence[Round], fresh: Sequence[Round], size: int) -> str:
    """Writes the comparison of the soaked service with a fresh one."""

    def ratio(of: str) -> float:
        pairs = zip(fresh, old, strict=True)
        return float(np.median([getattr(new, of) / getattr(used, of) for new, used in pairs]))

    def mean(rounds: Sequence[Round], of: str) -> float:
        return 1000.0 / size * float(np.mean([getattr(one, of) for one in rounds]))

    return (
        f"Afterwards it and a fresh service beside it did {len(old)} batches of {size} good runs "
        f"each in turn: it did {ratio('seconds'):.1%} of the fresh one's runs a second, and "
        f"{ratio('cpu_s'):.1%} of its runs a second of processor time (medians of pairs; server "
        f"{mean(old, 'server_cpu_s'):.1f} ms a run against {mean(fresh, 'server_cpu_s'):.1f} ms)."
    )


def pace(samples: Sequence[Sample], first: int, last: int, *, of: str) -> float:
    """Returns the runs between two samples a second of wall or processor time."""
    begin, end = samples[first], samples[last]
    return float((end.runs - begin.runs) / (getattr(end, of) - getattr(begin, of)))


def report(samples: Sequence[Sample], judgements: Sequence[Judgement], compared: str) -> str:
    """Writes the results in Markdown."""
    tenth = max(1, len(samples) // 10)
    # The start of the service is before the first sample.
    ratios = [
        pace(samples, -1 - tenth, -1, of=of) / pace(samples, 0, tenth, of=of)
        for of in ("seconds", "cpu_s")
    ]
    last = samples[-1]
    lines = [
        "# Soak",
        "",
        f"{last.runs} runs, of which {SHARE:.0%} of hostile agents, in {last.seconds / 60:.1f} "
        "minutes with two workers (`python -m benchmarks.soak`).",
        "",
        f"Lost {sum(j.lost for j in judgements)}, counted twice "
        f"{sum(j.twice for j in judgements)}, blamed wrongly {sum(j.blamed for j in judgements)}; "
        f"{sum(j.is_clean for j in judgements)} of {len(judgements)} batches without any fault.",
        "",
        f"The last tenth of the runs against the first: {ratios[0]:.1%} of its runs a second, "
        f"{ratios[1]:.1%} of its runs a second of processor time (whatever else the machine did).",
        "",
        compared,
        "",
        "| | first | last | most | growth for 1,000 runs, after the first quarter |",
        "|---|---|---|---|---|",
    ]
    settled = samples[len(samples) // 4 :]
    runs = np.array([s.runs for s in settled]) / 1000.0
    for name in FITTED:
        values = [getattr(s, name) for s in samples]
        slope = np.polyfit(runs, [getattr(s, name) for s in settled], 1)[0]
        lines.append(
            f"| {name.replace('_', ' ').replace('mib', 'MiB')} | {values[0]:.5g} | "
            f"{values[-1]:.5g} | {max(values):.5g} | {round(float(slope), 3):+g} |"
        )
    notes = [note for judgement in judgements for note in judgement.notes]
    return "\n".join([*lines, "", *[f"- {note}" for note in notes], ""]).rstrip() + "\n"


def main() -> None:
    """Soaks the service, prints and writes the results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=20_000)
    parser.add_argument("--batch", type=int, default=500, help="runs between two samples")
    parser.add_argument("--rounds", type=int, default=8, help="batches against a fresh service")
    parser.add_argument("--round", type=int, default=300, help="runs of such a batch")
    parser.add_argument("--out", type=Path, help="file to write the results to")
    options = parser.parse_args()
    if options.runs < 4 * options.batch:
        parser.error("four batches are the least that tells first from last")
    with tempfile.TemporaryDirectory() as folder:
        service, fresh = Service(Path(folder) / "soak"), Service(Path(folder) / "fresh")
        try:
            service.start()
            good = [Run(agent=DRIVER, kind=n % KINDS, seed=n % KINDS) for n in range(5 * KINDS)]
            hashes = undisturbed(service, service.post(good))
            samples, judgements = soak(service, options.runs, options.batch, hashes)
            fresh.start()
            old, new = in_turn((service, fresh), rounds=options.rounds, size=options.round)
            text = report(samples, judgements, against_fresh(old, new, options.round))
        finally:
            service.stop()
            fresh.stop()
    print(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
