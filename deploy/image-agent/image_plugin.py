"""The driver in Drivora's process, as an entry point of a package."""

from __future__ import annotations

from image_driver import ImageDriver

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.plugin import NoParameters, agent_plugin

PLUGIN = agent_plugin(
    AgentEntry(
        name="image-driver",
        kind=AgentKind.MODULE_BASED,
        description="drives by a bird's-eye image",
        source="example of an ADS that takes images",
        licence="Apache-2.0",
    ),
    NoParameters,
    lambda _: ImageDriver(),
)
