"""Batches by their priority."""

from __future__ import annotations

from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_index("ix_batches_priority", "batches", ["priority", "seq"])


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
