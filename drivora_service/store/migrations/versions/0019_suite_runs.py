"""Suites that were run, with the decisions of their gates."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "suite_runs",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("suite", sa.String(length=200), nullable=False),
        sa.Column("agent", sa.String(length=200), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fails", sa.Boolean(), nullable=False),
        sa.Column("scenarios", sa.Integer(), nullable=False),
        sa.Column("passing", sa.Integer(), nullable=False),
        sa.Column("body", sa.Text(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_suite_runs")),
        sa.UniqueConstraint("id", name=op.f("uq_suite_runs_id")),
    )
    op.create_index("ix_suite_runs_suite", "suite_runs", ["suite", "seq"])
    op.create_index(op.f("ix_suite_runs_revision"), "suite_runs", ["revision"])
    op.create_table(
        "suite_outcomes",
        sa.Column("run_seq", sa.Integer(), nullable=False),
        sa.Column("place", sa.Integer(), nullable=False),
        sa.Column("scenario", sa.String(length=400), nullable=False),
        sa.Column("state", sa.String(length=24), nullable=False),
        sa.Column("failing", sa.Integer(), nullable=False),
        sa.Column("judged", sa.Integer(), nullable=False),
        sa.Column("score", sa.Double(), nullable=True),
        sa.Column("run_id", sa.String(length=40), nullable=False),
        sa.Column("failures", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["run_seq"],
            ["suite_runs.seq"],
            name=op.f("fk_suite_outcomes_run_seq_suite_runs"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("run_seq", "place", name=op.f("pk_suite_outcomes")),
    )


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
