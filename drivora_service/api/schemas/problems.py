"""A single problem of a document that was posted."""

from __future__ import annotations

from pydantic import BaseModel, Field


class ProblemItem(BaseModel):
    """One problem and its place."""

    pointer: str = Field(description="JSON pointer (RFC 6901) into the body; empty: all of it.")
    code: str = Field(description="Short stable name of the kind of problem.")
    message: str = Field(description="What was found, what is allowed, what to do.")
