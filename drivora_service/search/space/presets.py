"""Named spaces: the default, and the spaces of published methods as far as they exist here.

The values of the published spaces are from the papers and their public code; what deviates stands
in the reference of the campaign file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import StrEnum
from types import MappingProxyType
from typing import Any

from drivora_service.scenario.model import RouteEnd
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts


class SpacePreset(StrEnum):
    """Name of a preset."""

    DEFAULT = "default"
    AVFUZZER = "avfuzzer"
    BEHAVEXPLOR = "behavexplor"
    DOPPELTEST = "doppeltest"


@dataclass(frozen=True, slots=True, kw_only=True)
class Preset:
    """A named space.

    Attributes:
        options: Its options.
        description: What varies.
        source: Publication; "" for a space of our own.
    """

    options: SpaceOptions
    description: str
    source: str

    @property
    def changed_options(self) -> dict[str, Any]:
        """The values of the options that differ from the default, by name."""
        default = SpaceOptions()
        return {
            one.name: getattr(self.options, one.name)
            for one in fields(SpaceOptions)
            if getattr(self.options, one.name) != getattr(default, one.name)
        }


PRESETS: Mapping[SpacePreset, Preset] = MappingProxyType(
    {
        SpacePreset.DEFAULT: Preset(
            options=SpaceOptions(),
            description="three NPC vehicles anywhere around the route, a walker, the weather",
            source="",
        ),
        SpacePreset.AVFUZZER: Preset(
            options=SpaceOptions(
                vehicles=2,
                walkers=0,
                weather=False,
                starts=VehicleStarts.FIXED,
                slices=5,
                slice_time=3.0,
                at_end=RouteEnd.STAY,
                max_deceleration=8.0,
                max_lateral_acceleration=4.0,
                min_speed=0.0,
                max_speed_factor=2.0,
            ),
            description="speed and manoeuvre of two NPC vehicles with fixed starts in five slices "
            "of 3 s: 20 genes",
            source="Li et al., AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems, "
            "2020",
        ),
        SpacePreset.BEHAVEXPLOR: Preset(
            options=SpaceOptions(
                vehicles=5,
                walkers=0,
                weather=False,
                slices=5,
                lane_changes=False,
                at_end=RouteEnd.STAY,
                min_speed=0.2,
                max_speed_factor=1.0,
            ),
            description="type, route, and the places and speeds of the waypoints of five NPC "
            "vehicles that stop at their ends",
            source="Cheng et al., BehAVExplor: Behavior Diversity Guided Testing for Autonomous "
            "Driving Systems, 2023",
        ),
        SpacePreset.DOPPELTEST: Preset(
            options=SpaceOptions(
                egos=5,
                vehicles=0,
                walkers=5,
                optional=True,
                weather=False,
                lights=True,
                max_walker_delay=30.0,
                max_ego_delay=15.0,
            ),
            description="two to five egos, up to five walkers, the times of the lights",
            source="Huai et al., Doppelgänger Test Generation for Revealing Bugs in Autonomous "
            "Driving Software, 2023",
        ),
    }
)
"""The presets by their names."""
