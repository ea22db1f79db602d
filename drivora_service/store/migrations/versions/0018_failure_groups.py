"""Groups of failures with what people have decided about them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None

_GROUPED = (
    "group_name",
    "group_seq",
    "accountability",
    "campaign_seq",
    "town",
    "oracle",
    "agent",
    "at_fault",
    "confirmation",
    "batch_seq",
    "found_at",
)
_TIME = sa.DateTime(timezone=True)


def upgrade() -> None:
    op.create_table(
        "failure_groups",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("label", sa.String(length=200), nullable=False),
        sa.Column("status", sa.String(length=16), nullable=False),
        sa.Column("status_at", _TIME, nullable=False),
        sa.Column("assignee", sa.String(length=100), nullable=False),
        sa.Column("note", sa.Text(), nullable=False),
        sa.Column("changed_at", _TIME, nullable=False),
        sa.Column("changed_by", sa.String(length=250), nullable=False),
        sa.Column("into_seq", sa.Integer(), nullable=True),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["into_seq"],
            ["failure_groups.seq"],
            name=op.f("fk_failure_groups_into_seq_failure_groups"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_failure_groups")),
        sa.UniqueConstraint("id", name=op.f("uq_failure_groups_id")),
    )
    op.create_index(op.f("ix_failure_groups_into_seq"), "failure_groups", ["into_seq"])
    op.create_index(op.f("ix_failure_groups_revision"), "failure_groups", ["revision"])
    op.create_table(
        "failure_group_names",
        sa.Column("name", sa.String(length=400), nullable=False),
        sa.Column("group_seq", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["group_seq"],
            ["failure_groups.seq"],
            name=op.f("fk_failure_group_names_group_seq_failure_groups"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_failure_group_names")),
    )
    op.create_index(op.f("ix_failure_group_names_group_seq"), "failure_group_names", ["group_seq"])
    op.create_table(
        "failure_group_changes",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("group_seq", sa.Integer(), nullable=False),
        sa.Column("changed_at", _TIME, nullable=False),
        sa.Column("changed_by", sa.String(length=250), nullable=False),
        sa.Column("what", sa.String(length=16), nullable=False),
        sa.Column("before", sa.Text(), nullable=False),
        sa.Column("after", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["group_seq"],
            ["failure_groups.seq"],
            name=op.f("fk_failure_group_changes_group_seq_failure_groups"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_failure_group_changes")),
    )
    op.create_index("ix_failure_group_changes_group", "failure_group_changes", ["group_seq", "seq"])
    op.drop_index("ix_found_failures_group", table_name="found_failures")
    # Without a foreign key, which SQLite adds only by copying the table; groups are never deleted.
    op.add_column("found_failures", sa.Column("group_seq", sa.Integer(), nullable=True))
    op.create_index("ix_found_failures_group", "found_failures", list(_GROUPED))
    op.create_index("ix_found_failures_group_seq", "found_failures", ["group_seq"])


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
