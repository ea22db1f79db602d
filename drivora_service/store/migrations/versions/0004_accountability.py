"""The accountability of an ego for its violations, and their severity.

Runs and campaigns of before were judged without it: their columns stay empty.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("runs", sa.Column("observations", sa.Integer(), nullable=True))
    op.add_column("verdicts", sa.Column("severity", sa.String(length=16), nullable=True))
    for table in ("runs", "verdicts", "evaluations", "failures"):
        op.add_column(table, sa.Column("accountability", sa.String(length=16), nullable=True))
    for count in ("avoidable", "unavoidable", "undetermined"):
        op.add_column("campaigns", sa.Column(count, sa.Integer(), nullable=True))


def downgrade() -> None:
    for count in ("undetermined", "unavoidable", "avoidable"):
        op.drop_column("campaigns", count)
    for table in ("failures", "evaluations", "verdicts", "runs"):
        op.drop_column(table, "accountability")
    op.drop_column("verdicts", "severity")
    op.drop_column("runs", "observations")
