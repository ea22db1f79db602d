"""The campaign document."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields as dataclass_fields
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Field,
    JsonValue,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from drivora_service.campaigns.document.campaign import (
    DEFAULT_LOOKAHEAD,
    Campaign,
    FeedbackMode,
    TesterChoice,
)
from drivora_service.campaigns.document.feedback_documents import FeedbackDocument
from drivora_service.campaigns.document.start_documents import StartDocument
from drivora_service.given_names import CHECKED_NAME
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.scenario import fields
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import AgentDocument, EntityDocument, FreeData
from drivora_service.scenario.model import AgentChoice, NpcBehavior, RouteEnd
from drivora_service.search.candidate_space import OwnSpace, SpaceChoice
from drivora_service.search.space.option_checks import MAX_MIN_SPEED, MAX_WAIT, SLICE_TIMES
from drivora_service.search.space.presets import PRESETS, SpacePreset
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts

_DEFAULTS = SpaceOptions()
MAX_ACTORS = 64
MAX_BUDGET = 1_000_000
MAX_LOOKAHEAD = 1024
MAX_SEEDS = 1000


def _count(low: int, high: int) -> Any:
    return Field(strict=True, ge=low, le=high, json_schema_extra={"x-unit": "1"})


def _number(unit: str, low: float, high: float) -> Any:
    return Field(
        strict=True, allow_inf_nan=False, ge=low, le=high, json_schema_extra={"x-unit": unit}
    )


def _zero_or(least: float) -> Callable[[float], float]:
    """Returns a check that a number is 0 or at least another."""

    def check(value: float) -> float:
        if 0.0 < value < least:
            raise PydanticCustomError(
                "too_small",
                "found {found}; 0 and {least} or more are allowed",
                {"found": value, "least": least},
            )
        return value

    return check


def _no_repetition(names: tuple[str, ...]) -> tuple[str, ...]:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise PydanticCustomError(
                "repeated_oracle", "found {name} more than once; give it once", {"name": repr(name)}
            )
    return names


def _no_second_name(seeds: tuple[SeedDocument, ...]) -> tuple[SeedDocument, ...]:
    names = [seed.name for seed in seeds]
    for index, name in enumerate(names):
        if name in names[:index]:
            raise PydanticCustomError(
                "repeated_name",
                "found the name {name} more than once; give each scenario another",
                {"name": repr(name)},
            )
    return seeds


PluginName = Annotated[str, Field(strict=True, pattern=fields.NAME_PATTERN)]
Actors = Annotated[int, _count(0, MAX_ACTORS)]
Patches = Annotated[int, _count(0, fields.MAX_FRICTION_PATCHES)]
Egos = Annotated[int, _count(1, fields.MAX_EGOS)]
Slices = Annotated[int, _count(1, 50)]
Paths = Annotated[int, _count(1, 1000)]
Reach = Annotated[float, _number("m", 10.0, 2000.0)]
SpeedFactor = Annotated[float, _number("1", 0.1, 3.0)]
Speed = Annotated[float, _number("m/s", 0.0, MAX_MIN_SPEED)]
SliceTime = Annotated[
    float, _number("s", 0.0, SLICE_TIMES[1]), AfterValidator(_zero_or(SLICE_TIMES[0]))
]
Limit = Annotated[
    float,
    _number("m/s²", 0.0, fields.ACCELERATIONS[1]),
    AfterValidator(_zero_or(fields.ACCELERATIONS[0])),
]
Wait = Annotated[float, _number("s", 0.0, MAX_WAIT)]
Delay = Annotated[float, _number("s", 0.0, 600.0)]
Simulations = Annotated[int, _count(1, MAX_BUDGET)]
Workers = Annotated[int, _count(1, 1024)]
Lookahead = Annotated[int, _count(1, MAX_LOOKAHEAD)]
OracleNames = Annotated[tuple[PluginName, ...], Field(min_length=1), AfterValidator(_no_repetition)]


class TesterDocument(EntityDocument):
    """The testing method."""

    name: PluginName = Field(description="A name of `drivora testers list`.")
    parameters: Annotated[dict[str, JsonValue], FreeData] = Field(
        default_factory=dict, description="Parameters that differ from the tester's defaults."
    )
    mutation: PluginName | None = Field(
        None, description="A mutation in place of the tester's own."
    )
    selection: PluginName | None = Field(
        None, description="A selection in place of the tester's own."
    )
    feedback: FeedbackMode = Field(
        FeedbackMode.OWN,
        description="own: the tester is told the results of its candidates; shuffled: it is told "
        "those of others, drawn at random, so that only its operators work.",
    )
    start_from: StartDocument | None = Field(
        None,
        description="Candidates of an earlier campaign, which it simulates first; without it, it "
        "draws its first candidates.",
    )


class SpaceDocument(EntityDocument):
    """The variable parts beside the fixed scenario."""

    name: PluginName | None = Field(
        None,
        description="A space of an installed package, in place of the one that all other keys but "
        "`parameters` describe.",
    )
    parameters: Annotated[dict[str, JsonValue], FreeData] | None = Field(
        None, description="With `name`: its parameters that differ from their defaults."
    )
    preset: SpacePreset | None = Field(
        None,
        description="A named space, whose values stand where none is given here.",
    )
    egos: Egos = Field(
        _DEFAULTS.egos,
        description="Number of egos. 1: the scenario's own, unchanged. More: routes, starts and "
        "start times of up to this many vary, two at least.",
    )
    vehicles: Actors = Field(_DEFAULTS.vehicles, description="NPC vehicles.")
    walkers: Actors = Field(_DEFAULTS.walkers, description="Walkers that cross an ego's way.")
    obstacles: Actors = Field(
        _DEFAULTS.obstacles, description="Static objects beside or partly on an ego's way."
    )
    patches: Patches = Field(_DEFAULTS.patches, description="Slippery patches on an ego's way.")
    optional: bool = Field(
        _DEFAULTS.optional, strict=True, description="Whether each of these may be absent."
    )
    slices: Slices = Field(
        _DEFAULTS.slices, description="Number of waypoints along an NPC vehicle's path."
    )
    behavior: NpcBehavior = Field(_DEFAULTS.behavior, description="Behavior of the NPC vehicles.")
    weather: bool = Field(_DEFAULTS.weather, strict=True, description="Whether the weather varies.")
    lights: bool = Field(
        _DEFAULTS.lights, strict=True, description="Whether the times of the lights vary."
    )
    reach: Reach = Field(
        _DEFAULTS.reach, description="NPC vehicles start at most this far from the egos' routes."
    )
    paths: Paths = Field(
        _DEFAULTS.paths, description="Greatest number of paths that NPC vehicles choose from."
    )
    starts: VehicleStarts = Field(
        _DEFAULTS.starts,
        description="free: model, path and start of NPC vehicles vary; fixed: they are chosen "
        "once, near the first ego, and only what the vehicles do varies.",
    )
    slice_time: SliceTime = Field(
        _DEFAULTS.slice_time,
        description="Seconds of a slice, in which an NPC vehicle drives at its speed, or stands, "
        "and keeps its lane or changes to the left or right. 0: slices are places on its path.",
    )
    lane_changes: bool = Field(
        _DEFAULTS.lane_changes, strict=True, description="Whether NPC vehicles change lanes."
    )
    at_end: RouteEnd = Field(
        _DEFAULTS.at_end,
        description="leave: NPC vehicles leave the road at the end of their way; stay: they brake "
        "to a standstill there, and stay.",
    )
    max_wait: Wait = Field(
        _DEFAULTS.max_wait,
        description="Longest time for which an NPC vehicle stands at one of its waypoints; 0: none "
        "does.",
    )
    max_deceleration: Limit = Field(
        _DEFAULTS.max_deceleration,
        description="Greatest planned braking of an NPC vehicle. 0: they are told none.",
    )
    max_lateral_acceleration: Limit = Field(
        _DEFAULTS.max_lateral_acceleration,
        description="Greatest lateral acceleration of an NPC vehicle in bends and lane changes. "
        "0: they are told none.",
    )
    min_speed: Speed = Field(
        _DEFAULTS.min_speed, description="Least desired speed of an NPC vehicle."
    )
    max_speed_factor: SpeedFactor = Field(
        _DEFAULTS.max_speed_factor,
        description="Greatest desired speed of an NPC vehicle over the speed limit of its lane.",
    )
    max_walker_delay: Delay = Field(
        _DEFAULTS.max_walker_delay, description="Latest start time of walkers."
    )
    max_ego_delay: Delay = Field(
        _DEFAULTS.max_ego_delay,
        description="Latest start time of egos, if egos vary.",
    )

    @model_validator(mode="after")
    def _own_or_built_in(self) -> SpaceDocument:
        if self.name is None:
            if self.parameters is not None:
                raise PydanticCustomError(
                    "space_name",
                    "found `parameters` without `name`; they are those of a package's space",
                )
            return self
        # A document that was stored by an earlier version may have the defaults, too.
        odd = [
            key
            for key in ("preset", *(option.name for option in dataclass_fields(SpaceOptions)))
            if getattr(self, key) != getattr(_DEFAULTS, key, None)
        ]
        if odd:
            raise PydanticCustomError(
                "space_name",
                "found {odd} beside `name`; the space {name} varies what it says itself: give "
                "`parameters`",
                {"odd": ", ".join(f"`{key}`" for key in odd), "name": repr(self.name)},
            )
        return self

    @model_serializer(mode="wrap")
    def _only_what_counts(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        content: dict[str, Any] = dump(self)
        if self.name is None:
            return {k: v for k, v in content.items() if k not in ("name", "parameters")}
        return {"name": self.name, "parameters": self.parameters or {}}

    @property
    def choice(self) -> SpaceChoice:
        """The space that it describes."""
        if self.name is not None:
            return OwnSpace(plugin=self.name, parameters=self.parameters or {})
        options = {one.name: getattr(self, one.name) for one in dataclass_fields(SpaceOptions)}
        return SpaceOptions(**options)

    @model_validator(mode="before")
    @classmethod
    def _fill_from_preset(cls, content: object) -> object:
        # The values become part of the document: a stored campaign keeps its space, whatever
        # becomes of the preset.
        if not isinstance(content, Mapping):
            return content
        given = {key: value for key, value in content.items() if value is not None}
        name = given.get("preset")
        if not isinstance(name, str) or name not in set(SpacePreset):
            return content
        options = PRESETS[SpacePreset(name)].options
        values = {one.name: getattr(options, one.name) for one in dataclass_fields(options)}
        return {**values, **given}


class SeedDocument(EntityDocument):
    """One of several seed scenarios."""

    name: Annotated[str, Field(strict=True, min_length=1, max_length=200), CHECKED_NAME] = Field(
        description="For results by seed scenario."
    )
    scenario: ScenarioDocument = Field(description="The scenario.")


class BudgetDocument(EntityDocument):
    """The budget of the campaign."""

    simulations: Simulations = Field(
        description="Number of simulations; invalid candidates do not count."
    )


class CampaignDocument(EntityDocument):
    """A search for scenarios in which an ADS fails."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    name: Annotated[str, Field(strict=True, min_length=1, max_length=200), CHECKED_NAME] = Field(
        description="For people."
    )
    tester: TesterDocument = Field(description="The tester of the campaign.")
    agent: AgentDocument | None = Field(
        None, description="The ADS of every ego; without it, as in the scenario."
    )
    scenario: ScenarioDocument | None = Field(None, description="The seed scenario.")
    scenarios: (
        Annotated[
            tuple[SeedDocument, ...], Field(max_length=MAX_SEEDS), AfterValidator(_no_second_name)
        ]
        | None
    ) = Field(
        None,
        validate_default=True,
        description="Several seed scenarios, in place of one; they take turns.",
    )
    space: SpaceDocument = Field(
        default_factory=SpaceDocument, description="The variable parts and their ranges."
    )
    budget: BudgetDocument = Field(description="The budget.")
    counts: Counted = Field(
        Counted.ACCOUNTABLE,
        description="Violations that are failures: those that an ego is accountable for; also "
        "those at the fault of others that a careful driver avoids (preventable); also unavoidable "
        "ones (at_fault), and those of undetermined fault (possibly_at_fault); or those of others, "
        "too (any).",
    )
    oracles: OracleNames | None = Field(
        None, description="The only oracles that count; without it, all but observations."
    )
    feedback: FeedbackDocument | None = Field(
        None,
        description="What the tester minimises; without it, what its own feedback measures.",
    )
    seed: fields.Seed = Field(0, description="Seed of every random draw of the search.")
    workers: Workers | None = Field(
        None, description="Worker processes; without it, as many as the installation has."
    )
    lookahead: Lookahead = Field(
        DEFAULT_LOOKAHEAD,
        description="Number of candidates that may wait for their results. It determines the "
        "search, the number of workers does not; it should be a few times that number.",
    )

    @field_validator("scenarios")
    @classmethod
    def _in_place_of_one(
        cls, scenarios: tuple[SeedDocument, ...] | None, info: ValidationInfo
    ) -> tuple[SeedDocument, ...] | None:
        # A scenario with problems of its own is not among the data.
        if "scenario" in info.data and (info.data["scenario"] is None) is not bool(scenarios):
            found = "both" if scenarios else "neither"
            raise PydanticCustomError(
                "seed_scenarios",
                "found {found} of `scenario` and `scenarios`; give the seed scenario, or several",
                {"found": found},
            )
        return scenarios

    @property
    def definition(self) -> FailureDefinition:
        """What counts as a failure."""
        oracles = None if self.oracles is None else tuple(sorted(self.oracles))
        return FailureDefinition(counts=self.counts, oracles=oracles)

    @property
    def seeds(self) -> Mapping[str, ScenarioDocument]:
        """The seed scenarios by their names, in order; a single one has the name ""."""
        if self.scenario is not None:
            return {"": self.scenario}
        return {one.name: one.scenario for one in self.scenarios or ()}


def to_campaign(document: CampaignDocument) -> Campaign:
    """Returns the campaign of a document."""
    tester, agent = document.tester, document.agent
    return Campaign(
        name=document.name,
        tester=TesterChoice(
            name=tester.name,
            parameters=tester.parameters,
            mutation=tester.mutation or "",
            selection=tester.selection or "",
            feedback=tester.feedback,
        ),
        agent=None if agent is None else AgentChoice(name=agent.name, parameters=agent.parameters),
        space=document.space.choice,
        budget=document.budget.simulations,
        definition=document.definition,
        seed=document.seed,
        workers=document.workers,
        lookahead=document.lookahead,
    )


def campaign_text(document: CampaignDocument) -> str:
    """Writes a document as JSON that reads back to an equal one."""
    return document.model_dump_json(exclude_none=True)
