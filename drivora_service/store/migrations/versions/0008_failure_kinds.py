"""Counters of the kinds of failures of a campaign, and indices for the filters of its lists."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

_COUNTS = ("failures", "violations", "at_fault", "avoidable", "confirmed", "flaky", "first")


def upgrade() -> None:
    kinds = op.create_table(
        "failure_kinds",
        sa.Column("campaign_seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("key", sa.String(length=400), nullable=False),
        *(sa.Column(name, sa.Integer(), nullable=False) for name in (*_COUNTS, "clusters")),
        sa.ForeignKeyConstraint(
            ["campaign_seq"],
            ["campaigns.seq"],
            name=op.f("fk_failure_kinds_campaign_seq_campaigns"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("campaign_seq", "key", name=op.f("pk_failure_kinds")),
    )
    names = ("campaign_seq", "key", "number", "at_fault", "accountability", "confirmation")
    failures = sa.table("failures", *(sa.column(name) for name in (*names, "cluster"))).c
    op.execute(
        kinds.insert().from_select(
            ["campaign_seq", "key", *_COUNTS, "clusters"],
            sa.select(
                failures.campaign_seq,
                failures.key,
                sa.func.count(failures.number.distinct()),
                sa.func.count(),
                _evaluations_if(failures.number, failures.at_fault.is_(sa.true())),
                _evaluations_if(failures.number, failures.accountability == "avoidable"),
                _evaluations_if(failures.number, failures.confirmation == "confirmed"),
                _evaluations_if(failures.number, failures.confirmation == "flaky"),
                sa.func.min(failures.number),
                sa.func.count(failures.cluster.distinct()),
            ).group_by(failures.campaign_seq, failures.key),
        )
    )
    op.drop_index("ix_failures_key", table_name="failures")
    op.create_index(
        "ix_failures_filters",
        "failures",
        [
            "campaign_seq",
            "number",
            "place",
            "oracle",
            "key",
            "at_fault",
            "accountability",
            "confirmation",
        ],
    )
    op.add_column(
        "evaluations",
        sa.Column("violating", sa.Boolean(), server_default=sa.false(), nullable=False),
    )
    evaluations = sa.table("evaluations", sa.column("violations"), sa.column("violating"))
    op.execute(evaluations.update().where(evaluations.c.violations > 0).values(violating=sa.true()))
    by = ["status", "violating", "number"]
    op.create_index("ix_evaluations_status", "evaluations", ["campaign_seq", *by])
    op.create_index("ix_evaluations_generation", "evaluations", ["campaign_seq", "generation", *by])


def _evaluations_if(
    number: sa.ColumnElement[int], condition: sa.ColumnElement[bool]
) -> sa.ColumnElement[int]:
    return sa.func.count(sa.case((condition, number)).distinct())


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
