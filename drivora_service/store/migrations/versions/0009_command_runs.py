"""Batches with runs reserved for the process of one command; kinds and groups of failures."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column(
        "batches",
        sa.Column("owner_id", sa.String(length=40), server_default=sa.text("''"), nullable=False),
    )
    op.create_index(
        "ix_batches_owner",
        "batches",
        ["owner_id"],
        sqlite_where=sa.text("owner_id != ''"),
        postgresql_where=sa.text("owner_id != ''"),
    )
    op.execute("ALTER TABLE failures RENAME COLUMN key TO kind")
    op.execute("ALTER TABLE failures RENAME COLUMN cluster TO group_number")
    op.execute("ALTER TABLE failure_kinds RENAME COLUMN key TO kind")
    op.execute("ALTER TABLE failure_kinds RENAME COLUMN clusters TO groups")


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
