"""The tables of facets: how many runs, and how many failures, share what lists filter by."""

from __future__ import annotations

from sqlalchemy import BigInteger, Boolean, ForeignKey, Integer, String
from sqlalchemy.orm import Mapped, mapped_column

from drivora_service.store.tables import Base


class FacetRow(Base):
    """What lists of runs filter by, and how many runs have it; see ``store.facets``."""

    __tablename__ = "facets"

    key: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    agent: Mapped[str] = mapped_column(String(200))
    town: Mapped[str] = mapped_column(String(100))
    status: Mapped[str] = mapped_column(String(24))
    violated: Mapped[bool | None] = mapped_column(Boolean)
    accountability: Mapped[str | None] = mapped_column(String(16))
    runs: Mapped[int] = mapped_column(Integer, default=0)


class BatchFacetRow(Base):
    """How many runs of a batch have a facet."""

    __tablename__ = "batch_facets"

    batch_seq: Mapped[int] = mapped_column(
        ForeignKey("batches.seq", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    facet: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    runs: Mapped[int] = mapped_column(Integer, default=0)
