"""The failures of all campaigns and batches in one table, in the order of finding them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import sqlalchemy as sa
from alembic import op

from drivora_service.errors import DrivoraError
from drivora_service.oracles.verdict import Outcome, Severity
from drivora_service.oracles.verdicts.failure_facts import failure_group
from drivora_service.oracles.verdicts.verdict_json import verdict_from_json
from drivora_service.runs.report_encoding import report_from_json

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None

_CHUNK = 5000
_GROUPED = (
    "group_name",
    "accountability",
    "campaign_seq",
    "town",
    "oracle",
    "agent",
    "at_fault",
    "confirmation",
    "batch_seq",
    "found_at",
)


def upgrade() -> None:
    found = op.create_table(
        "found_failures",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("found_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("campaign_seq", sa.Integer(), nullable=True),
        sa.Column("number", sa.Integer(), nullable=True),
        sa.Column("run_seq", sa.Integer(), nullable=True),
        sa.Column("batch_seq", sa.Integer(), nullable=True),
        sa.Column("place", sa.Integer(), nullable=False),
        sa.Column("oracle", sa.String(length=60), nullable=False),
        sa.Column("group_name", sa.String(length=400), nullable=False),
        sa.Column("agent", sa.String(length=200), nullable=False),
        sa.Column("town", sa.String(length=100), nullable=False),
        sa.Column("at_fault", sa.Boolean(), nullable=True),
        sa.Column("accountability", sa.String(length=16), nullable=True),
        sa.Column(
            "confirmation", sa.String(length=16), server_default=sa.text("''"), nullable=False
        ),
        sa.ForeignKeyConstraint(
            ["campaign_seq"],
            ["campaigns.seq"],
            name=op.f("fk_found_failures_campaign_seq_campaigns"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["run_seq"],
            ["runs.seq"],
            name=op.f("fk_found_failures_run_seq_runs"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_found_failures")),
    )
    connection = op.get_bind()
    rows = [*_of_campaigns(connection), *_of_runs(connection)]
    rows.sort(key=lambda row: row["found_at"])
    for start in range(0, len(rows), _CHUNK):
        connection.execute(found.insert(), rows[start : start + _CHUNK])
    op.create_index(
        "ix_found_failures_campaign", "found_failures", ["campaign_seq", "number", "place"]
    )
    op.create_index("ix_found_failures_run", "found_failures", ["run_seq"])
    op.create_index("ix_found_failures_group", "found_failures", list(_GROUPED))


def _of_campaigns(connection: sa.Connection) -> Iterator[dict[str, Any]]:
    towns = {seq: _towns(document) for seq, document in _rows(connection, _CAMPAIGNS)}
    for row in _rows(connection, _FAILURES):
        of_seeds = towns[row.campaign_seq]
        seed = row.seed_number if row.seed_number < len(of_seeds) else 0
        yield {
            "found_at": row.told_at,
            "campaign_seq": row.campaign_seq,
            "number": row.number,
            "run_seq": None,
            "batch_seq": None,
            "place": row.place,
            "oracle": row.oracle,
            "group_name": failure_group(verdict_from_json(row.verdict)),
            "agent": row.agent,
            "town": of_seeds[seed] if of_seeds else row.town,
            "at_fault": row.at_fault,
            "accountability": row.accountability,
            "confirmation": row.confirmation,
        }


def _of_runs(connection: sa.Connection) -> Iterator[dict[str, Any]]:
    stored: dict[tuple[int, str, str], list[Any]] = {}
    run_seq = -1
    for row in _rows(connection, _VERDICTS):
        if row.run_seq != run_seq:
            run_seq = row.run_seq
            stored.clear()
            for place, verdict in enumerate(_verdicts(row.body)):
                counts = verdict.severity is not Severity.OBSERVATION
                if verdict.outcome is Outcome.VIOLATED and counts:
                    key = (run_seq, verdict.oracle, verdict.ego)
                    stored.setdefault(key, []).append((place, verdict))
        told = stored.get((row.run_seq, row.oracle, row.ego))
        if not told:
            continue
        place, verdict = told.pop(0)
        yield {
            "found_at": row.ended_at,
            "campaign_seq": None,
            "number": None,
            "run_seq": row.run_seq,
            "batch_seq": row.batch_seq,
            "place": place,
            "oracle": row.oracle,
            "group_name": failure_group(verdict),
            "agent": row.agent,
            "town": row.town,
            "at_fault": row.at_fault,
            "accountability": row.accountability,
            "confirmation": "",
        }


def _verdicts(body: str) -> Any:
    try:
        return report_from_json(body).verdicts
    except (ValueError, DrivoraError):
        # A report of an older version that is read no more names no failure.
        return ()


def _towns(document: str) -> list[str]:
    """Returns the road networks of the seed scenarios; none if there is only one."""
    seeds = json.loads(document).get("scenarios") or ()
    return [seed["scenario"]["map_region"]["town"] for seed in seeds]


def _rows(connection: sa.Connection, query: sa.Executable) -> Iterator[Any]:
    yield from connection.execute(query, execution_options={"yield_per": 1000})


_CAMPAIGNS = sa.text("SELECT seq, document FROM campaigns")
_FAILURES = sa.text(
    "SELECT f.*, e.told_at, e.seed_number, c.agent, c.town FROM failures f "
    "JOIN evaluations e ON e.campaign_seq = f.campaign_seq AND e.number = f.number "
    "JOIN campaigns c ON c.seq = f.campaign_seq ORDER BY f.campaign_seq, f.number, f.place"
).columns(told_at=sa.DateTime(timezone=True), at_fault=sa.Boolean())
_VERDICTS = sa.text(
    "SELECT v.run_seq, v.batch_seq, v.oracle, v.ego, v.at_fault, v.accountability, r.agent, "
    "r.town, r.ended_at, p.body FROM verdicts v JOIN runs r ON r.seq = v.run_seq "
    "JOIN reports p ON p.run_seq = v.run_seq JOIN batches b ON b.seq = r.batch_seq "
    "WHERE v.outcome = 'violated' AND v.severity != 'observation' "
    "AND b.id NOT IN (SELECT batch_id FROM campaigns WHERE batch_id != '') "
    "ORDER BY v.run_seq, v.seq"
).columns(ended_at=sa.DateTime(timezone=True), at_fault=sa.Boolean())


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
