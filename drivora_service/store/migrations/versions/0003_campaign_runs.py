"""Campaigns with evaluations as runs of the queue, and their best scores."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("runs", sa.Column("feedback", sa.Text(), nullable=True))
    op.add_column(
        "runs", sa.Column("keeps_trace", sa.Boolean(), server_default=sa.true(), nullable=False)
    )
    op.add_column(
        "campaigns",
        sa.Column("batch_id", sa.String(length=40), server_default=sa.text("''"), nullable=False),
    )
    op.add_column("campaigns", sa.Column("best", sa.Text(), server_default="{}", nullable=False))


def downgrade() -> None:
    op.drop_column("campaigns", "best")
    op.drop_column("campaigns", "batch_id")
    op.drop_column("runs", "keeps_trace")
    op.drop_column("runs", "feedback")
