"""One status for failures of plug-ins, also for runs that ended as oracle_failed."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

_OLD, _NEW = "oracle_failed", "plugin_failed"


def upgrade() -> None:
    _rename(_OLD, _NEW)


def downgrade() -> None:
    _rename(_NEW, _OLD)


def _rename(old: str, new: str) -> None:
    runs = sa.table("runs", sa.column("status", sa.String))
    op.execute(runs.update().where(runs.c.status == old).values(status=new))
    for name, column in (("reports", "body"), ("evaluations", "report")):
        text = sa.column(column, sa.Text)
        before, after = f'"status":"{old}"', f'"status":"{new}"'
        op.execute(
            sa.table(name, text)
            .update()
            .where(text.contains(before))
            .values({column: sa.func.replace(text, before, after)})
        )
