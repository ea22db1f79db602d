"""Since when slots do what they do, when their last worker died, and runs by their end."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("slots", sa.Column("since", sa.DateTime(timezone=True), nullable=True))
    op.add_column("slots", sa.Column("last_crash_at", sa.DateTime(timezone=True), nullable=True))
    condition = sa.text("ended_at IS NOT NULL")
    op.create_index(
        "ix_runs_ended",
        "runs",
        ["ended_at"],
        sqlite_where=condition,
        postgresql_where=condition,
    )


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
