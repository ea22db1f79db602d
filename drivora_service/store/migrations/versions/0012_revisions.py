"""One count of changes for runs, batches, campaigns and studies."""

from __future__ import annotations

import secrets

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "change_epochs",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=16), nullable=False),
        sa.Column("last", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_change_epochs")),
        sa.UniqueConstraint("id", name=op.f("uq_change_epochs_id")),
    )
    connection = op.get_bind()
    last = connection.scalar(sa.text("SELECT max(revision) FROM runs")) or 0
    for table in ("batches", "campaigns", "studies"):
        op.add_column(
            table,
            sa.Column("revision", sa.Integer(), server_default=sa.text("0"), nullable=False),
        )
        # Each object has a revision of its own, so that changes can be read in parts.
        connection.execute(sa.text(f"UPDATE {table} SET revision = :last + seq"), {"last": last})
        last += connection.scalar(sa.text(f"SELECT max(seq) FROM {table}")) or 0
        op.create_index(f"ix_{table}_revision", table, ["revision"])
    condition = sa.text("batch_id != ''")
    op.create_index(
        "ix_campaigns_batch",
        "campaigns",
        ["batch_id"],
        sqlite_where=condition,
        postgresql_where=condition,
    )
    connection.execute(
        sa.text("INSERT INTO change_epochs (id, last) VALUES (:id, :last)"),
        {"id": secrets.token_hex(6), "last": last},
    )


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
