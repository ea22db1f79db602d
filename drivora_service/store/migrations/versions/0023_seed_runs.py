"""Campaigns know the runs of their seed scenarios, and how often the ADS itself failed.

The count is null for campaigns from before: it is in the reports of their evaluations only.
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


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
