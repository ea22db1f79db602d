"""The part of campaign and study documents that chooses what is minimised."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

from pydantic import AfterValidator, Field, JsonValue, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.scenario.entities import EntityDocument, FreeData

MAX_OBJECTIVES = 100

ObjectiveName = Annotated[
    str, Field(strict=True, min_length=1, max_length=200, pattern=r"^[A-Za-z0-9_./-]+$")
]
Positive = Annotated[
    float,
    Field(strict=True, allow_inf_nan=False, gt=0.0, le=1e9, json_schema_extra={"x-unit": "1"}),
]
Target = Annotated[
    float,
    Field(strict=True, allow_inf_nan=False, ge=-1e9, le=1e9, json_schema_extra={"x-unit": "1"}),
]


class Direction(StrEnum):
    """The direction of a search."""

    MINIMISE = "minimise"
    MAXIMISE = "maximise"


class ObjectiveDocument(EntityDocument):
    """An objective of a search."""

    name: ObjectiveName = Field(
        description="An objective, a metric or a traffic law: a name of `drivora metrics list`."
    )
    direction: Direction | None = Field(
        None,
        description="Direction of the search; without it, the one that is worse for the ADS.",
    )
    target: Target | None = Field(
        None,
        description="Value that is a failure, in the unit of the objective; without it, 0 for "
        "objectives, and none for metrics.",
    )
    scale: Positive = Field(
        1.0,
        description="Distance from the target that counts one half, in the unit of the objective, "
        "where objectives are weighed or a method needs values in 0..1.",
    )
    weight: Positive | None = Field(
        None,
        description="Weight in a sum of all; without any weight, each is an objective by itself.",
    )

    @property
    def words(self) -> str:
        """The objective in a few words, for reports."""
        given = {"target": self.target, "weight": self.weight}
        told = [f"{key} {value:g}" for key, value in given.items() if value is not None]
        way = "" if self.direction is None else f"{self.direction.value} "
        return f"{way}{self.name}" + (f" ({', '.join(told)})" if told else "")


def _no_second_objective(chosen: tuple[ObjectiveDocument, ...]) -> tuple[ObjectiveDocument, ...]:
    names = [one.name for one in chosen]
    for index, name in enumerate(names):
        if name in names[:index]:
            raise PydanticCustomError(
                "repeated_objective", "found {name} more than once; give it once", {"name": name}
            )
    return chosen


class FeedbackDocument(EntityDocument):
    """What a search minimises, in place of the objectives of the tester's own feedback."""

    name: ObjectiveName | None = Field(
        None,
        description="An objective, a metric or a traffic law, or a feedback with all of its "
        "objectives: a name of `drivora metrics list`.",
    )
    parameters: Annotated[dict[str, JsonValue], FreeData] = Field(
        default_factory=dict,
        description="Parameters that differ from the defaults of a feedback.",
    )
    direction: Direction | None = Field(
        None,
        description="Direction of the search; without it, the one that is worse for the ADS.",
    )
    target: Target | None = Field(
        None,
        description="Value that is a failure, in the unit of the objective; without it, 0 for "
        "objectives, and none for metrics.",
    )
    scale: Positive = Field(
        1.0,
        description="Distance from the target that counts one half, in the unit of the objective, "
        "where a method needs values in 0..1.",
    )
    objectives: (
        Annotated[
            tuple[ObjectiveDocument, ...],
            Field(min_length=1, max_length=MAX_OBJECTIVES),
            AfterValidator(_no_second_objective),
        ]
        | None
    ) = Field(None, description="Several objectives, in place of one.")

    @model_validator(mode="after")
    def _one_or_several(self) -> FeedbackDocument:
        if (self.name is None) is (self.objectives is None):
            found = "neither" if self.name is None else "both"
            raise PydanticCustomError(
                "feedback_choice",
                "found {found} of `name` and `objectives`; give one name, or several objectives",
                {"found": found},
            )
        # A stored document has the defaults, too.
        defaults: dict[str, object] = {
            "parameters": {},
            "direction": None,
            "target": None,
            "scale": 1.0,
        }
        odd = [name for name, value in defaults.items() if getattr(self, name) != value]
        if self.objectives is not None and odd:
            raise PydanticCustomError(
                "feedback_choice",
                "found {odd} beside `objectives`; give it to each objective",
                {"odd": ", ".join(odd)},
            )
        return self

    @property
    def words(self) -> str:
        """The choice in a few words, for reports."""
        return ", ".join(one.words for one in self.chosen)

    @property
    def chosen(self) -> tuple[ObjectiveDocument, ...]:
        """The objectives; of one name, that one."""
        if self.objectives is not None:
            return self.objectives
        return (
            ObjectiveDocument(
                name=self.name or "",
                direction=self.direction,
                target=self.target,
                scale=self.scale,
                weight=None,
            ),
        )
