"""Guarantees of every testing method: nothing is lost, kills and K change nothing.

    python -m benchmarks.method_checks budget --networks MAPS --out FILE
    python -m benchmarks.method_checks kills --out FILE

``budget`` runs a campaign of every method on two shipped networks and Town01, and counts what
became of the candidates. ``kills`` runs one of every method, on a scene in which it finds failures,
with two workers, again with one, and again with three SIGKILLs at random moments, and compares the
evaluations one by one. A method that keeps checkpoints (`deepcollision`) goes on from the last one
after a kill; how many evaluations that one has is reported. `deepcollision` is left out, with a
message, where its extra is not installed.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.method_campaigns import TELLING, make_generated_campaign, make_telling_campaign
from benchmarks.methods import METHODS, installed_methods
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.records.stored_campaigns import use_one_thread
from drivora_service.campaigns.search.conducting import conduct
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.search.space.own_space import make_space
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.store.database import open_database
from drivora_service.studies.campaign_figures import Subject, figures_of
from drivora_service.worker.setup import WorkerSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """A campaign to be run."""

    tester: str
    town: str
    simulations: int
    seed: int = 1


def run_whole(
    setup: WorkerSetup, networks: NetworkCatalogue, wanted: Wanted, workers: int
) -> dict[str, Any]:
    """Runs a campaign; returns the counts of its candidates."""
    catalogues = Catalogues(networks)
    document = make_generated_campaign(
        networks, wanted.tester, wanted.town, seed=wanted.seed, simulations=wanted.simulations
    )
    valid = read_campaign(json.dumps(document), catalogues)
    search = prepare_search(valid, catalogues, run_prefix="check")
    journal = MemoryJournal()
    # As in the process of a campaign: more threads take the cores of its workers.
    use_one_thread()
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(slots=workers, setup=setup, folder=Path(folder)) as executor,
    ):
        begun = time.perf_counter()
        conduct(search, LocalEvaluator(executor), journal, confirm=False)
        wall = time.perf_counter() - begun
    records = list(journal.evaluations())
    status = [record.status for record in records]
    figures = figures_of(
        Subject(campaign="", method=wanted.tester, scenario=wanted.town, seed=wanted.seed),
        records,
        [
            make_space(seed.scenario, seed.network, valid.campaign.space).genes
            for seed in valid.seeds
        ],
        definition=valid.campaign.definition,
    )
    return {
        "method": wanted.tester,
        "town": wanted.town,
        "simulations": figures.simulations,
        "judged": status.count(EvaluationStatus.JUDGED),
        "lost": status.count(EvaluationStatus.FAILED),
        "invalid": status.count(EvaluationStatus.INVALID),
        "failing": figures.failing,
        "at_fault": figures.at_fault,
        "kinds": figures.kinds,
        "wall_s": round(wall, 1),
        "run_ms": round(1000.0 * figures.simulation_s / figures.simulations, 1),
        "own_ms": round(1000.0 * figures.own_s / figures.simulations, 1),
        "own_share": round(figures.own_share, 3),
    }


def check_budgets(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Runs every method on every town."""
    networks = NetworkCatalogue(shipped_networks(), options.networks)
    setup = WorkerSetup(shipped_networks=shipped_networks(), imported_networks=options.networks)
    for town in ("tee-town", "signal-grid", *(["Town01"] if options.networks else [])):
        for tester in options.testers:
            wanted = Wanted(tester=tester, town=town, simulations=options.simulations)
            yield run_whole(setup, networks, wanted, options.workers)


def read_sequence(data: Path, campaign_id: str) -> list[tuple[object, ...]]:
    """Returns the parts of a campaign's evaluations that must not depend on circumstances."""
    database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    try:
        records = list(StoreJournal(database, campaign_id).evaluations())
    finally:
        database.close()
    return [_comparison_key(record) for record in records]


def _comparison_key(record: EvaluationRecord) -> tuple[object, ...]:
    report = record.report
    return (
        record.number,
        record.proposal.values.tobytes(),
        record.proposal.origin,
        record.proposal.generation,
        record.proposal.parents,
        record.status,
        record.document_sha256,
        record.failure_kinds,
        None if report is None else report.trace_sha256,
    )


def command(data: Path, *arguments: str) -> list[str]:
    """Returns a command line of ``drivora campaign``."""
    return [sys.executable, "-m", "drivora_service.cli", "campaign", *arguments, "--data-dir",
            str(data), "--json"]  # fmt: skip


def finish(data: Path, *arguments: str) -> str:
    """Runs a command to its end; returns the campaign's id.

    Raises:
        SystemExit: It failed; has what it printed.
    """
    done = subprocess.run(command(data, *arguments), capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"drivora campaign {' '.join(arguments)}: {done.stderr}")
    return str(json.loads(done.stdout)["id"])


def find_newest_campaign(data: Path) -> tuple[str, int]:
    """Returns the newest campaign and its number of evaluations; ("", 0) for none."""
    database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    try:
        with database.read() as transaction:
            for record in transaction.campaigns.page(limit=1).items:
                return record.id, record.counts.evaluations
    finally:
        database.close()
    return "", 0


def kill_at(data: Path, process: subprocess.Popen[bytes], told: int) -> int:
    """Kills a campaign's process group after a number of evaluations; returns their number."""
    while process.poll() is None:
        if find_newest_campaign(data)[1] >= told:
            os.killpg(process.pid, signal.SIGKILL)
            break
        time.sleep(0.05)
    process.wait()
    return find_newest_campaign(data)[1]


def last_checkpoint(data: Path) -> int:
    """Returns the evaluations before the newest campaign's last checkpoint; 0 without any."""
    folder = CampaignFolder(data / "campaigns", find_newest_campaign(data)[0]).path / "checkpoints"
    return max((int(path.stem) for path in folder.glob("*.checkpoint")), default=0)


def check_kills(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Runs every method uninterrupted with K = 2 and K = 1, and with three kills."""
    for tester in options.testers:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            file = folder / "campaign.json"
            document = make_telling_campaign(
                tester, seed=options.seed, simulations=options.simulations
            )
            file.write_text(json.dumps(document))
            two = finish(folder / "two", "run", str(file), "--workers", "2")
            one = finish(folder / "one", "run", str(file), "--workers", "1")
            luck = random.Random(f"{tester} {options.seed}")
            moments = sorted(luck.sample(range(1, options.simulations - 1), 3))
            killed: list[int] = []
            resumed_at: list[int] = []
            data, arguments = folder / "killed", ["run", str(file)]
            for moment in moments:
                process = subprocess.Popen(
                    command(data, *arguments),
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,
                )
                # Several evaluations are told at once: not before others than the last time.
                least = killed[-1] + 1 if killed else 0
                told = min(max(moment, least), options.simulations - 1)
                killed.append(kill_at(data, process, told))
                resumed_at.append(last_checkpoint(data))
                arguments = ["resume", find_newest_campaign(data)[0]]
            finish(data, *arguments)
            whole = read_sequence(folder / "two", two)
            alone = read_sequence(folder / "one", one)
            again = read_sequence(data, arguments[1])
            yield {
                "method": tester,
                "scene": TELLING[tester].scene,
                "evaluations": len(whole),
                "failing": sum(bool(one[7]) for one in whole),
                "one_worker_the_same": alone == whole,
                "killed_after": killed,
                "checkpoints": resumed_at,
                "killed_the_same": again == whole,
            }


def print_table(rows: Iterator[dict[str, Any]], out: Path | None) -> None:
    """Prints rows, and writes them as lines of JSON."""
    header: Sequence[str] = ()
    for row in rows:
        if not header:
            header = list(row)
            print("|", " | ".join(header), "|")
            print("|", " | ".join("---" for _ in header), "|")
        print("|", " | ".join(str(row[name]) for name in header), "|", flush=True)
        if out is not None:
            out.parent.mkdir(parents=True, exist_ok=True)
            with out.open("a") as file:
                file.write(json.dumps(row) + "\n")


def main() -> None:
    """Runs the checks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    budget = commands.add_parser("budget", help="every method on three towns")
    budget.add_argument("--networks", type=Path, help="folder with Town01.net.xml")
    budget.add_argument("--simulations", type=int, default=500)
    budget.add_argument("--workers", type=int, default=2)
    budget.set_defaults(check=check_budgets)
    kills = commands.add_parser("kills", help="every method, killed three times")
    kills.add_argument("--simulations", type=int, default=150)
    kills.add_argument("--seed", type=int, default=1)
    kills.set_defaults(check=check_kills)
    for checking in (budget, kills):
        checking.add_argument("--testers", nargs="+", choices=METHODS, default=list(METHODS))
        checking.add_argument("--out", type=Path)
    options = parser.parse_args()
    options.testers, left_out = installed_methods(options.testers)
    for one in left_out:
        print(f"Left out: {one}.", file=sys.stderr)
    print_table(options.check(options), options.out)


if __name__ == "__main__":
    main()
