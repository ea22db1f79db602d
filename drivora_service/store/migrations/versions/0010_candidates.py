"""Runs of candidates that their workers decode; hashes of proposed values; seed scenarios."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("runs", sa.Column("candidate", sa.Text(), nullable=True))
    op.add_column("reports", sa.Column("candidate", sa.Text(), nullable=True))
    op.add_column("evaluations", sa.Column("asked_sha256", sa.String(length=64), nullable=True))
    op.add_column(
        "evaluations",
        sa.Column("seed_number", sa.Integer(), server_default=sa.text("0"), nullable=False),
    )


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
