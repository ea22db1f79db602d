"""Genes of the weather and of the traffic lights, and their decoding."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.model import LightTimes, TrafficLights, Weather
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.layout import number

_LOWEST_SUN = 0.0
_DENSEST_FOG = 85.0
"""Per cent: a visibility of 111 m. With heavy rain and glare 62 m of sight are left."""
_GREENS = (5.0, 30.0)
"""Seconds; signal programmes give a green at least 5 s."""
_LATEST_OFFSET = 60.0


def weather_genes() -> list[Gene]:
    """Returns the genes of the weather, named as the fields of ``Weather``.

    Two conditions are left to the seed, since together with the others they make driving
    impossible: standing water (rain and wetness leave a friction of 0.7, deposits 0.4), and night
    (in fog and rain a fifth of the sight, and so much noise that standing actors seem to move).
    """
    return [
        number("precipitation", 0.0, 100.0, "%"),
        number("wetness", 0.0, 100.0, "%"),
        number("fog_density", 0.0, _DENSEST_FOG, "%"),
        number("cloudiness", 0.0, 100.0, "%"),
        number("sun_altitude_angle", _LOWEST_SUN, 90.0, "deg"),
    ]


def weather(block: Block, values: FloatArray, seed: Weather) -> Weather:
    """Returns the weather; fields without a gene are the seed's."""
    own = values[block.slice].tolist()
    named = {gene.name: value for gene, value in zip(block.genes, own, strict=True)}
    return replace(seed, **named)


def light_genes() -> list[Gene]:
    """Returns the genes of the light times of all junctions.

    Yellow is left to the network: one too short for the speed limit could not be obeyed.
    """
    return [number("green", *_GREENS, "s"), number("offset", 0.0, _LATEST_OFFSET, "s")]


def traffic_lights(block: Block, values: FloatArray, seed: TrafficLights) -> TrafficLights:
    """Returns the light times; junctions with times of their own in the seed keep them."""
    green, offset = values[block.slice].tolist()
    times = replace(seed.times, green=green, offset=offset)
    return TrafficLights(
        times=times,
        junctions={name: _fill_missing_times(own, times) for name, own in seed.junctions.items()},
    )


def _fill_missing_times(own: LightTimes, common: LightTimes) -> LightTimes:
    """Returns a junction's times; missing ones are those of all junctions."""
    return replace(
        own,
        green=common.green if own.green is None else own.green,
        offset=common.offset if own.offset is None else own.offset,
    )
