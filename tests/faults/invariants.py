"""The invariants after every fault, checked in the database and over HTTP."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service, Work

Hashes = Mapping[tuple[str, int], str]
"""Hash of the trace of an undisturbed run, by agent and scenario."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """The effects of a fault.

    Attributes:
        lost: Runs that were accepted and have no end, or an end without a report.
        twice: Runs that were counted more than once.
        blamed: Runs of good agents that ended otherwise than finished, or otherwise than they do
            undisturbed; and good scenarios in quarantine.
        back: Whether the service finished all and is ready, by itself.
        notes: Remarks on what was found.
    """

    lost: int
    twice: int
    blamed: int
    back: bool
    notes: list[str] = field(default_factory=list)

    @property
    def is_clean(self) -> bool:
        """Whether nothing was harmed."""
        return self.back and not (self.lost or self.twice or self.blamed)


def judge(service: Service, work: Work, hashes: Hashes, *, seconds: float = 100.0) -> Judgement:
    """Waits until all work has ended, and checks the results."""
    back, notes = True, []
    try:
        service.wait_until_ended(work, len(work.runs), seconds=seconds)
        wait_until(service.is_ready, seconds=30.0, what=f"not ready: {service.readiness()}")
    except AssertionError as error:
        back = False
        notes.append(str(error))
    lost = _lost(service, work, notes)
    twice = _twice(service, work, notes)
    blamed = _blamed(service, work, hashes, notes)
    damaged = [row for row in service.query("PRAGMA integrity_check") if "ok" not in row.values()]
    if damaged:
        back = False
        notes.append(f"the database is damaged: {damaged}")
    if back and not (told := _told_over_http(service, work)):
        back = told
        notes.append("the API tells otherwise than the database")
    return Judgement(lost=lost, twice=twice, blamed=blamed, back=back, notes=notes)


def _lost(service: Service, work: Work, notes: list[str]) -> int:
    rows = service.query(
        "SELECT r.id, r.status, p.run_seq IS NOT NULL AS reported FROM runs r "
        "LEFT JOIN reports p ON p.run_seq = r.seq JOIN batches b ON b.seq = r.batch_seq "
        "WHERE b.id = ?",
        work.batch,
    )
    kept = {
        row["id"] for row in rows if row["status"] not in ("queued", "running") and row["reported"]
    }
    lost = set(work.runs) - kept
    if lost:
        states = {row["id"]: row["status"] for row in rows}
        notes.append(f"lost: {sorted((run, states.get(run, 'no row')) for run in lost)}"[:500])
    return len(lost)


def _twice(service: Service, work: Work, notes: list[str]) -> int:
    of_batch = "JOIN runs r ON r.seq = x.run_seq JOIN batches b ON b.seq = r.batch_seq"
    attempts = service.query(
        f"SELECT r.id FROM attempts x {of_batch} WHERE b.id = ? AND "
        "x.outcome = r.status GROUP BY x.run_seq HAVING count(*) > 1 AND r.status = 'finished'",
        work.batch,
    )
    verdicts = service.query(
        f"SELECT r.id FROM verdicts x {of_batch} WHERE b.id = ? "
        "GROUP BY x.run_seq, x.oracle, x.ego, x.time, x.counterpart HAVING count(*) > 1",
        work.batch,
    )
    known = service.statuses(work)
    twice = {row["id"] for row in (*attempts, *verdicts)} | (set(known) - set(work.runs))
    if twice:
        notes.append(f"counted twice: {sorted(twice)}"[:500])
    return len(twice)


def _blamed(service: Service, work: Work, hashes: Hashes, notes: list[str]) -> int:
    rows = service.query(
        "SELECT r.id, r.status, r.cause, r.trace_sha256 FROM runs r "
        "JOIN batches b ON b.seq = r.batch_seq WHERE b.id = ?",
        work.batch,
    )
    blamed = []
    for row in rows:
        run = work.runs.get(row["id"])
        if run is None or not run.is_good or row["status"] in ("queued", "running"):
            continue
        wanted = hashes.get((run.agent, run.kind))
        if row["status"] != "finished":
            blamed.append((row["status"], row["cause"]))
        elif wanted is not None and row["trace_sha256"] != wanted:
            blamed.append(("finished", "another trace"))
    quarantined = [
        row
        for row in service.query("SELECT run_id, cause, signal FROM quarantine")
        if row["run_id"] in work.runs and work.runs[row["run_id"]].is_good
    ]
    if blamed or quarantined:
        notes.append(f"blamed: {blamed}, quarantined: {quarantined}"[:500])
    return len(blamed) + len(quarantined)


def _told_over_http(service: Service, work: Work) -> bool:
    told: dict[str, str] = {}
    with service.client() as client:
        batch = client.get(f"/batches/{work.batch}").raise_for_status().json()
        token = ""
        while True:
            wanted: dict[str, str | int]
            wanted = {"batch": work.batch, "limit": 500, "page_token": token}
            page = client.get("/jobs", params=wanted).raise_for_status().json()
            told |= {job["id"]: job["status"] for job in page["items"]}
            if not (token := page["next_page_token"]):
                break
    return (
        bool(batch["done"]) and batch["size"] == len(work.runs) and told == service.statuses(work)
    )


def undisturbed(service: Service, work: Work) -> Hashes:
    """Waits until work has ended and returns the hashes of its traces.

    Raises:
        AssertionError: A run of it was not finished.
    """
    service.wait_until_ended(work, len(work.runs))
    found: dict[tuple[str, int], str] = {}
    for row in service.query("SELECT id, status, cause, trace_sha256 FROM runs"):
        if run := work.runs.get(row["id"]):
            assert row["status"] == "finished", row
            found[run.agent, run.kind] = row["trace_sha256"]
    assert len(set(found.values())) > 1
    assert all(found.values())
    return found
