"""The tables of facets: numbers of runs by the attributes that lists filter by."""

from __future__ import annotations

from sqlalchemy import BigInteger, Boolean, ForeignKey, String, text
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.engine.base_tables import Base


class FacetRow(Base):
    """A facet and its number of runs; see ``store.runs.facets``."""

    __tablename__ = "facets"

    key: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    agent: Mapped[str] = mapped_column(String(200))
    configuration: Mapped[str] = mapped_column(String(400), default="", server_default=text("''"))
    configuration_id: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    town: Mapped[str] = mapped_column(String(100))
    status: Mapped[str] = mapped_column(String(24))
    violated: Mapped[bool | None] = mapped_column(Boolean)
    accountability: Mapped[str | None] = mapped_column(String(16))
    failing: Mapped[bool | None] = mapped_column(Boolean)
    runs: Mapped[int] = mapped_column(default=0)


class BatchFacetRow(Base):
    """The number of runs of a batch with a facet."""

    __tablename__ = "batch_facets"

    batch_seq: Mapped[int] = mapped_column(
        ForeignKey("batches.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    facet: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    runs: Mapped[int] = mapped_column(default=0)
