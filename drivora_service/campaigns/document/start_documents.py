"""The part of campaign and study documents with the candidates that a search starts from."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.scenario.entities import EntityDocument

MAX_STARTS = 1000
"""Greatest number of candidates to start from."""

_MAX_GENES = 100_000

Value = Annotated[float, Field(allow_inf_nan=False, json_schema_extra={"x-unit": "SI"})]


class StartKind(StrEnum):
    """The candidates of an earlier campaign that a search starts from."""

    FAILURES = "failures"
    """Candidates that failed."""
    ELITES = "elites"
    """Candidates that were nearest to a failure by their objectives."""


class StartCandidateDocument(EntityDocument):
    """A candidate, by its genes."""

    seed: Annotated[str, Field(strict=True, max_length=200)] = Field(
        "", description="Name of its seed scenario; empty if there is only one."
    )
    values: Annotated[tuple[Value, ...], Field(min_length=1, max_length=_MAX_GENES)] = Field(
        description="Its genes, in the order of the space."
    )


class StartDocument(EntityDocument):
    """Candidates of an earlier campaign, which are the first ones of this search."""

    source: Annotated[str, Field(strict=True, min_length=1, max_length=500)] = Field(
        description="Where they are from, for people."
    )
    kind: StartKind = Field(description="Whether they failed, or were nearest to a failure.")
    network_sha256: Annotated[str, Field(strict=True, max_length=64)] | None = Field(
        None,
        description="Hash of the road networks for which the genes were made; without it, that is "
        "not checked.",
    )
    candidates: Annotated[
        tuple[StartCandidateDocument, ...], Field(min_length=1, max_length=MAX_STARTS)
    ] = Field(description="The candidates, the most important ones first.")

    @model_validator(mode="before")
    @classmethod
    def _has_genes(cls, content: object) -> object:
        if isinstance(content, Mapping):
            for key in ("campaign", "folder"):
                if key in content:
                    raise PydanticCustomError(
                        "start_source",
                        "found a {key}; only the command line looks it up: give the genes in "
                        "`candidates`",
                        {"key": key},
                    )
        return content

    def of_seed(self, name: str) -> tuple[StartCandidateDocument, ...]:
        """Returns the candidates of a seed scenario."""
        return tuple(one for one in self.candidates if one.seed == name)

    @property
    def words(self) -> str:
        """The start in a few words, for reports."""
        count = len(self.candidates)
        kind = str(self.kind) if count > 1 else str(self.kind).removesuffix("s")
        return f"{count} {kind} of {self.source}"
