"""The parameters that the manifest of an ADS declares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, make_dataclass
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.given_names import CHECKED_NOTE
from drivora_service.parameters import parameter_problems

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ParameterKind = Literal["number", "integer", "boolean", "text"]
ParameterValue = bool | int | float | str

_TYPES: dict[ParameterKind, type[ParameterValue]] = {
    "number": float,
    "integer": int,
    "boolean": bool,
    "text": str,
}
_Limit = Annotated[float, Field(allow_inf_nan=False)]
_WHOLE = 2.0**63
"""Largest limit of an integer that can be checked."""
_Text = Annotated[str, Field(strict=True, max_length=2000)]
_Shown = Annotated[str, Field(strict=True, max_length=2000), CHECKED_NOTE]
_Value = (
    Annotated[bool, Field(strict=True)]
    | Annotated[int, Field(strict=True)]
    | Annotated[float, Field(strict=True, allow_inf_nan=False)]
    | Annotated[str, Field(strict=True, max_length=2000)]
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ManifestParameter:
    """A parameter of an ADS.

    Attributes:
        default: Value without it; ``None`` if the manifest has none.
        minimum: Least allowed number.
        maximum: Greatest allowed number.
        choices: Allowed texts; empty: any.
    """

    name: str
    kind: ParameterKind
    default: ParameterValue | None = None
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    description: str = ""


class ParameterDocument(BaseModel):
    """A parameter in a manifest."""

    model_config = ConfigDict(extra="forbid")

    type: ParameterKind
    default: _Value | None = None
    minimum: _Limit | None = None
    maximum: _Limit | None = None
    choices: tuple[_Text, ...] = ()
    description: _Shown = ""

    @model_validator(mode="after")
    def _limits_fit(self) -> Self:
        limited = self.minimum is not None or self.maximum is not None
        if limited and self.type not in ("number", "integer"):
            raise _misfit(f"minimum and maximum are for numbers; found type {self.type}")
        if self.choices and self.type != "text":
            raise _misfit(f"choices are texts; found type {self.type}")
        for limit in (self.minimum, self.maximum):
            if self.type == "integer" and limit is not None and not _is_whole(limit):
                raise _misfit(
                    f"the limits of an integer are whole numbers between -2^63 and 2^63; found "
                    f"{limit:g}"
                )
        low, high = self.minimum, self.maximum
        if low is not None and high is not None and low > high:
            raise _misfit(f"minimum {low:g} is above maximum {high:g}")
        return self

    @model_validator(mode="after")
    def _default_is_allowed(self) -> Self:
        if self.default is not None:
            type_ = parameters_type((self.parameter("default"),))
            for problem in parameter_problems(type_, {"default": self.default}, of="the parameter"):
                raise _misfit(problem.message)
        return self

    def parameter(self, name: str) -> ManifestParameter:
        """Returns the parameter under its name."""
        return ManifestParameter(
            name=name,
            kind=self.type,
            default=self.default,
            minimum=self.minimum,
            maximum=self.maximum,
            choices=self.choices,
            description=self.description,
        )


@cache
def parameters_type(parameters: Sequence[ManifestParameter]) -> type[DataclassInstance]:
    """Makes the dataclass for checking documents."""
    fields = [
        (parameter.name, _annotation(parameter), field(default=parameter.default))
        for parameter in parameters
    ]
    return make_dataclass("ManifestParameters", fields, frozen=True, slots=True, kw_only=True)


def _annotation(parameter: ManifestParameter) -> Any:
    type_: Any = _TYPES[parameter.kind]
    if parameter.choices:
        type_ = Literal[parameter.choices]
    return Annotated[
        type_,
        Field(
            ge=parameter.minimum, le=parameter.maximum, description=parameter.description or None
        ),
    ]


def _is_whole(limit: float) -> bool:
    return limit.is_integer() and abs(limit) < _WHOLE


def _misfit(message: str) -> PydanticCustomError:
    return PydanticCustomError("parameter", "{message}", {"message": message})
