"""Gene spaces for testing testers without a simulator."""

from __future__ import annotations

from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part


def small_space(
    *, egos: int = 3, vehicles: int = 3, walkers: int = 2, slices: int = 4, patches: int = 0
) -> GeneSpace:
    """Returns a space with all parts, with blocks named and arranged as those of scenarios.

    Patches are among them only where they are asked for.
    """
    blocks: list[Block] = []
    start = 0

    def add(name: str, part: Part, genes: list[Gene]) -> None:
        nonlocal start
        actor = "" if part in (Part.WEATHER, Part.LIGHTS) else name
        blocks.append(Block(name=name, part=part, start=start, genes=tuple(genes), actor=actor))
        start += len(genes)

    for i in range(egos):
        first = 1.0 if i < 2 else 0.0
        add(
            f"ego_{i}",
            Part.EGO,
            [
                _whole("present", first, 1.0),
                _choice("path", 6),
                _number("start", 0.0, 1.0),
                _number("start_time", 0.0, 15.0, "s"),
            ],
        )
    for i in range(vehicles):
        genes = [_whole("present", 0.0, 1.0), _choice("model", 4), _choice("path", 10)]
        genes.append(_number("start", 0.0, 1.0))
        genes += [_number(f"speed_{k}", 0.0, 18.0, "m/s") for k in range(slices)]
        genes += [_whole(f"lane_{k}", -1.0, 1.0) for k in range(slices)]
        genes += [_number(f"along_{k}", -12.0, 12.0, "m") for k in range(slices)]
        add(f"vehicle_{i}", Part.VEHICLE, genes)
    for i in range(walkers):
        add(
            f"walker_{i}",
            Part.WALKER,
            [
                _whole("present", 0.0, 1.0),
                _choice("path", 3),
                _number("place", 0.0, 1.0),
                _choice("side", 2),
                _number("angle", -0.7, 0.7, "rad"),
                _number("speed", 1.25, 3.0, "m/s"),
                _number("start_time", 0.0, 15.0, "s"),
            ],
        )
    for i in range(patches):
        add(
            f"patch_{i}",
            Part.PATCH,
            [
                _whole("present", 0.0, 1.0),
                _choice("path", 3),
                _number("place", 0.0, 1.0),
                _number("lateral", -1.5, 1.5, "m"),
                _number("length", 2.0, 30.0, "m"),
                _number("width", 1.0, 8.0, "m"),
                _number("friction", 0.05, 0.6),
            ],
        )
    add(
        "weather",
        Part.WEATHER,
        [_number(name, 0.0, 100.0, "%") for name in ("precipitation", "wetness", "fog_density")],
    )
    add(
        "lights", Part.LIGHTS, [_number("green", 5.0, 15.0, "s"), _number("offset", 0.0, 30.0, "s")]
    )
    return GeneSpace(tuple(blocks))


def _number(name: str, low: float, high: float, unit: str = "") -> Gene:
    return Gene(name=name, kind=GeneKind.CONTINUOUS, low=low, high=high, unit=unit)


def _whole(name: str, low: float, high: float) -> Gene:
    return Gene(name=name, kind=GeneKind.INTEGER, low=low, high=high)


def _choice(name: str, count: int) -> Gene:
    return Gene(name=name, kind=GeneKind.CATEGORY, low=0.0, high=count - 1.0)
