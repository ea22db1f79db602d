"""Studies, and the place of campaigns in them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "studies",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("request", sa.String(length=16), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_studies")),
        sa.UniqueConstraint("id", name=op.f("uq_studies_id")),
    )
    op.add_column(
        "campaigns",
        sa.Column("study_id", sa.String(length=40), server_default=sa.text("''"), nullable=False),
    )
    for name in ("study_scenario", "study_agent", "study_method"):
        op.add_column(
            "campaigns",
            sa.Column(name, sa.String(length=100), server_default=sa.text("''"), nullable=False),
        )
    op.add_column(
        "campaigns",
        sa.Column("repetition", sa.Integer(), server_default=sa.text("0"), nullable=False),
    )
    op.create_index("ix_campaigns_study", "campaigns", ["study_id", "state", "seq"])


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
