"""Campaigns know the runs of their seed scenarios, how often the ADS itself failed, and others did.

The counts are null for campaigns from before: they are in the reports of their evaluations only.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0023"
down_revision = "0022"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column(
        "campaigns", sa.Column("seed_runs", sa.Text(), server_default="[]", nullable=False)
    )
    op.add_column("campaigns", sa.Column("agent_failed", sa.Integer(), nullable=True))
    op.add_column("campaigns", sa.Column("not_at_fault", sa.Integer(), nullable=True))


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
