"""What documents can name or begin with: example scenarios, networks, agents and testers.

And the oracles that judge runs.
"""

from __future__ import annotations

from typing import Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.oracles.oracle_descriptions import (
    MeasureDescription,
    ThresholdDescription,
    ViolatedBy,
)
from drivora_service.oracles.verdict import Severity
from drivora_service.scenario.models.actor_models import ActorKind, VehicleClass


class ExampleScenario(Schema):
    """An example scenario that comes with the package."""

    name: str
    document: dict[str, Any] = Field(description="It can be posted as it is.")


class ExampleScenarioList(Schema):
    """All example scenarios."""

    items: tuple[ExampleScenario, ...]


class NetworkSummary(Schema):
    """A road network in the list."""

    name: str
    url: str


class Network(Schema):
    """A road network."""

    name: str
    sha256: str = Field(description="Hash of its file.")
    bounds: tuple[float, float, float, float] = Field(
        description="min x, min y, max x, max y in metres."
    )
    net_offset: tuple[float, float] = Field(
        description="Added to the source's coordinates, metres."
    )
    lanes: int
    drivable_km: float = Field(description="Kilometres of lane outside junctions.")
    traffic_lights: int
    has_sidewalks: bool
    geometry_url: str


class Model(Schema):
    """A model of actors."""

    name: str
    kind: ActorKind
    vehicle_class: VehicleClass | None = Field(description="null if it is not a vehicle.")
    length: float = Field(description="Metres.")
    width: float = Field(description="Metres.")
    height: float = Field(description="Metres.")
    max_speed: float = Field(description="m/s; 0 if it does not move.")


class ModelList(Schema):
    """All models of actors."""

    items: tuple[Model, ...]


class AgentParameter(Schema):
    """A parameter of an agent."""

    name: str
    default: Any = Field(description="Its value unless a document sets it; null: not known.")
    values: dict[str, Any] = Field(description="JSON Schema of the values that it may have.")
    description: str


class Agent(Schema):
    """An ADS that can drive an ego."""

    name: str
    kind: str
    description: str
    source: str
    licence: str
    version: str = Field(description="Of its package, or of its manifest; else empty.")
    parameters: tuple[AgentParameter, ...] | None = Field(
        description="Documents are checked against them; null where it does not declare them."
    )
    privileged: bool = Field(
        description="Whether it sees more than the perception model lets through."
    )
    installed: bool
    reason: str = Field(description="Why it cannot be used here; empty if it can.")


class AgentList(Schema):
    """All agents."""

    items: tuple[Agent, ...]


class NetworkList(Schema):
    """All networks."""

    items: tuple[NetworkSummary, ...]


class TesterParameter(Schema):
    """A parameter of a tester."""

    name: str
    default: Any = Field(description="Its value unless a campaign sets it.")
    values: dict[str, Any] = Field(description="JSON Schema of the values that it may have.")
    description: str


class Tester(Schema):
    """A testing method that a campaign can name."""

    name: str
    title: str = Field(description="The method's own name.")
    description: str
    source: str = Field(description="Paper or package that it follows.")
    generational: bool = Field(description="Whether it waits for a whole generation.")
    feedback: str = Field(description="Feedback that measures its evaluations.")
    parameters: tuple[TesterParameter, ...]
    installed: bool
    reason: str = Field(description="Why it cannot be used here; empty if it can.")


class TesterList(Schema):
    """All testers."""

    items: tuple[Tester, ...]


class Oracle(Schema):
    """An oracle that judges every run."""

    name: str
    description: str
    definition: str = Field(
        description="What it is violated by, in one sentence; the description for a package's."
    )
    severity: Severity | None = Field(
        description="The greatest severity of its violations; null for a package's. Observations "
        "count only where a definition of failures names the oracle."
    )
    unit: str = Field(description="Unit of what it measures; empty if it happens or not.")
    violated_by: ViolatedBy | None = Field(
        description="Direction in which the measure violates it; null for a package's."
    )
    source: str = Field(description="Where the definition comes from; a package's name for its.")
    threshold_descriptions: tuple[ThresholdDescription, ...] = Field(
        description="Meaning, unit and source of each threshold; empty for a package's."
    )
    thresholds: dict[str, Any] = Field(description="Its parameters; SI units.")
    package: str = Field(description="Its package; empty for a built-in oracle and a law.")
    formula: str = Field(description="Its formula, if it is a traffic law; else empty.")
    file: str = Field(description="The user's law file that it is from; else empty.")
    installed: bool
    reason: str = Field(description="Why it cannot judge; no run is judged then. Empty if it can.")


class MeasureList(Schema):
    """All metrics, and the objectives of searches, those of packages among them."""

    items: tuple[MeasureDescription, ...]


class OracleList(Schema):
    """All oracles."""

    items: tuple[Oracle, ...]
