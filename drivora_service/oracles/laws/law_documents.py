"""Law files: one or more traffic laws with their formulas."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from drivora_service.given_names import CHECKED_NAME, CHECKED_NOTE
from drivora_service.oracles.verdict import Severity

NAME = r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$"
MAX_LAWS = 100
MAX_PARAMETERS = 30

_Sentence = Annotated[str, Field(strict=True, min_length=1, max_length=2000), CHECKED_NOTE]
_Name = Annotated[str, Field(strict=True, pattern=NAME, max_length=60)]


class _Document(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class LawParameterDocument(_Document):
    """A number in a formula, by name."""

    value: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e9, le=1e9)] = Field(
        description="Its value."
    )
    unit: Annotated[str, Field(strict=True, max_length=20), CHECKED_NAME] = Field(
        description="Its unit, made of m, s and rad: m/s, m/s², s; 1 for a share."
    )
    meaning: _Sentence = Field(description="One sentence.")


class LawDocument(_Document):
    """One traffic law: an oracle of its own."""

    name: _Name = Field(
        description="Name of the oracle: lower-case letters and digits in words joined by _."
    )
    title: Annotated[str, Field(strict=True, min_length=1, max_length=120), CHECKED_NAME] = Field(
        description="A few words."
    )
    source: _Sentence = Field(description="The law and its article.")
    description: _Sentence = Field(description="One sentence: what violates it.")
    left_out: Annotated[str, Field(strict=True, max_length=2000), CHECKED_NOTE] = Field(
        "", description="What of the article the formula leaves out."
    )
    severity: Severity = Field(
        Severity.OBSERVATION,
        description="Severity of its violations; observations are failures only where a campaign, "
        "a suite or a gate names the law.",
    )
    parameters: Annotated[dict[_Name, LawParameterDocument], Field(max_length=MAX_PARAMETERS)] = (
        Field(default_factory=dict, description="Numbers that the formula names.")
    )
    formula: Annotated[str, Field(strict=True, min_length=1)] = Field(
        description="`always (CONDITION)`: the condition holds at every moment of the ego's part."
    )


class LawFileDocument(_Document):
    """A file of traffic laws."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    laws: Annotated[tuple[LawDocument, ...], Field(min_length=1, max_length=MAX_LAWS)] = Field(
        description="The laws."
    )
