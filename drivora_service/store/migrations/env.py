"""Alembic's entry: migrates the connection that it is handed."""

from __future__ import annotations

from alembic import context

from drivora_service.store.engine.base_tables import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
