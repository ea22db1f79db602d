"""Campaigns, their evaluations and failures."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "campaigns",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("tester", sa.String(length=64), nullable=False),
        sa.Column("agent", sa.String(length=200), nullable=False),
        sa.Column("town", sa.String(length=100), nullable=False),
        sa.Column("network_sha256", sa.String(length=64), nullable=False),
        sa.Column("budget", sa.Integer(), nullable=False),
        sa.Column("versions", sa.Text(), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("message", sa.Text(), nullable=False),
        sa.Column("request", sa.String(length=16), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("ended_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("active_s", sa.Double(), nullable=False),
        sa.Column("evaluations", sa.Integer(), nullable=False),
        sa.Column("judged", sa.Integer(), nullable=False),
        sa.Column("invalid", sa.Integer(), nullable=False),
        sa.Column("failed", sa.Integer(), nullable=False),
        sa.Column("violating", sa.Integer(), nullable=False),
        sa.Column("at_fault", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_campaigns")),
        sa.UniqueConstraint("id", name=op.f("uq_campaigns_id")),
    )
    op.create_index("ix_campaigns_state", "campaigns", ["state", "seq"], unique=False)
    op.create_table(
        "evaluations",
        sa.Column("campaign_seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("generation", sa.Integer(), nullable=False),
        sa.Column("origin", sa.String(length=60), nullable=False),
        sa.Column("parents", sa.Text(), nullable=False),
        sa.Column("genes", sa.Text(), nullable=False),
        sa.Column("status", sa.String(length=16), nullable=False),
        sa.Column("document_sha256", sa.String(length=64), nullable=True),
        sa.Column("violations", sa.Integer(), nullable=False),
        sa.Column("at_fault_violations", sa.Integer(), nullable=False),
        sa.Column("sim_time_s", sa.Double(), nullable=False),
        sa.Column("wall_time_s", sa.Double(), nullable=False),
        sa.Column("search_s", sa.Double(), nullable=False),
        sa.Column("prepare_s", sa.Double(), nullable=False),
        sa.Column("told_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("report", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["campaign_seq"],
            ["campaigns.seq"],
            name=op.f("fk_evaluations_campaign_seq_campaigns"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["document_sha256"],
            ["documents.sha256"],
            name=op.f("fk_evaluations_document_sha256_documents"),
        ),
        sa.PrimaryKeyConstraint("campaign_seq", "number", name=op.f("pk_evaluations")),
    )
    op.create_index(
        "ix_evaluations_document_sha256", "evaluations", ["document_sha256"], unique=False
    )
    op.create_index(
        "ix_evaluations_violating",
        "evaluations",
        ["campaign_seq", "number"],
        unique=False,
        sqlite_where=sa.text("violations > 0"),
        postgresql_where=sa.text("violations > 0"),
    )
    op.create_table(
        "failures",
        sa.Column("campaign_seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("place", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("oracle", sa.String(length=60), nullable=False),
        sa.Column("key", sa.String(length=400), nullable=False),
        sa.Column("at_fault", sa.Boolean(), nullable=True),
        sa.Column("confirmation", sa.String(length=16), nullable=False),
        sa.Column("cluster", sa.Integer(), nullable=True),
        sa.Column("trace", sa.Text(), nullable=False),
        sa.Column("verdict", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["campaign_seq"],
            ["campaigns.seq"],
            name=op.f("fk_failures_campaign_seq_campaigns"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("campaign_seq", "number", "place", name=op.f("pk_failures")),
    )
    op.create_index("ix_failures_key", "failures", ["campaign_seq", "key"], unique=False)


def downgrade() -> None:
    op.drop_index("ix_failures_key", table_name="failures")
    op.drop_table("failures")
    op.drop_index(
        "ix_evaluations_violating",
        table_name="evaluations",
        sqlite_where=sa.text("violations > 0"),
        postgresql_where=sa.text("violations > 0"),
    )
    op.drop_index("ix_evaluations_document_sha256", table_name="evaluations")
    op.drop_table("evaluations")
    op.drop_index("ix_campaigns_state", table_name="campaigns")
    op.drop_table("campaigns")
