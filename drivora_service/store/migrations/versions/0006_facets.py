"""Facets of runs: one number for the filter attributes of lists, with counters."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

from drivora_service.store.runs.facets import Facet, facet_key

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

_OF_RUNS = (
    "seq",
    "batch_seq",
    "agent",
    "town",
    "status",
    "violations",
    "accountability",
    "facet",
)
_RUNS = sa.table("runs", *(sa.column(name) for name in _OF_RUNS))
_VERDICTS = sa.table("verdicts", *(sa.column(name) for name in ("run_seq", "batch_seq", "facet")))


def upgrade() -> None:
    facets = op.create_table(
        "facets",
        sa.Column("key", sa.BigInteger(), autoincrement=False, nullable=False),
        sa.Column("agent", sa.String(length=200), nullable=False),
        sa.Column("town", sa.String(length=100), nullable=False),
        sa.Column("status", sa.String(length=24), nullable=False),
        sa.Column("violated", sa.Boolean(), nullable=True),
        sa.Column("accountability", sa.String(length=16), nullable=True),
        sa.Column("runs", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("key", name=op.f("pk_facets")),
    )
    batch_facets = op.create_table(
        "batch_facets",
        sa.Column("batch_seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("facet", sa.BigInteger(), autoincrement=False, nullable=False),
        sa.Column("runs", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["batch_seq"],
            ["batches.seq"],
            name=op.f("fk_batch_facets_batch_seq_batches"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("batch_seq", "facet", name=op.f("pk_batch_facets")),
    )
    for table, column in (
        ("runs", sa.Column("facet", sa.BigInteger(), server_default="0", nullable=False)),
        ("verdicts", sa.Column("batch_seq", sa.Integer(), server_default="0", nullable=False)),
        ("verdicts", sa.Column("facet", sa.BigInteger(), server_default="0", nullable=False)),
    ):
        op.add_column(table, column)
    # First, so that no index has to follow the changes of the rows.
    for name in ("batch_seq_status", "status", "agent", "town", "document_sha256", "violated"):
        op.drop_index(f"ix_runs_{name}", table_name="runs")
    op.drop_index("ix_verdicts_oracle", table_name="verdicts")
    _fill(facets, batch_facets)
    op.create_index("ix_runs_facet", "runs", ["facet", "seq"])
    op.create_index("ix_runs_batch_facet", "runs", ["batch_seq", "facet", "seq"])
    op.create_index("ix_runs_document_facet", "runs", ["document_sha256", "facet", "seq"])
    said = ["oracle", "outcome", "at_fault", "facet", "run_seq"]
    op.create_index("ix_verdicts_facet", "verdicts", said)
    op.create_index("ix_verdicts_batch_facet", "verdicts", ["batch_seq", *said])


def _fill(facets: sa.Table, batch_facets: sa.Table) -> None:
    connection = op.get_bind()
    runs = _RUNS.c
    fields = (runs.agent, runs.town, runs.status, runs.violations > 0, runs.accountability)
    for *values, number in connection.execute(
        sa.select(*fields, sa.func.count()).group_by(*fields)
    ).all():
        agent, town, status, violated, accountability = values
        facet = Facet(
            agent=agent,
            town=town,
            status=status,
            violated=None if violated is None else bool(violated),
            accountability=accountability,
        )
        connection.execute(
            facets.insert().values(
                key=facet_key(facet),
                agent=agent,
                town=town,
                status=status,
                violated=facet.violated,
                accountability=accountability,
                runs=number,
            )
        )
    known = facets.c
    same = (
        (known.agent == runs.agent)
        & (known.town == runs.town)
        & (known.status == runs.status)
        & known.violated.is_not_distinct_from(runs.violations > 0)
        & known.accountability.is_not_distinct_from(runs.accountability)
    )
    key = sa.select(known.key).where(same).scalar_subquery()
    connection.execute(_RUNS.update().values(facet=key))
    counted = sa.select(runs.batch_seq, runs.facet, sa.func.count())
    connection.execute(
        batch_facets.insert().from_select(
            ["batch_seq", "facet", "runs"], counted.group_by(runs.batch_seq, runs.facet)
        )
    )
    for column in ("batch_seq", "facet"):
        of_run = sa.select(runs[column]).where(runs.seq == _VERDICTS.c.run_seq).scalar_subquery()
        connection.execute(_VERDICTS.update().values({column: of_run}))


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
