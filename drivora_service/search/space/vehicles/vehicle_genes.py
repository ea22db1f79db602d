"""Genes of an NPC vehicle."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.search.genes import Gene
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.layout import choice, number, presence, whole
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts
from drivora_service.search.space.vehicles.npc_paths import NpcPath

MODELS = (
    "vehicle.nissan.micra",
    "vehicle.lincoln.mkz_2017",
    "vehicle.volkswagen.t2",
    "vehicle.tesla.cybertruck",
    "vehicle.mercedes.sprinter",
    "vehicle.carlamotors.carlacola",
    "vehicle.yamaha.yzf",
)
"""Small and large cars, vans, a truck and a motorcycle, all narrower than any lane."""
MAX_SHIFT = 12.0
"""Greatest move of a waypoint along the path, metres."""
MANOEUVRES = (0, 1, -1)
"""Lanes to the left by which each manoeuvre of a slice of time changes: none, left, right."""
WAITING = ("waits", "wait_at", "wait_time")
"""Names of the genes that tell whether a vehicle stands, at which waypoint, and how long."""
LEAST_DECELERATION = 2.0
"""m/s²: braking that passengers hardly notice."""
LEAST_LATERAL_ACCELERATION = 1.0
"""m/s²: a lane change of some four seconds."""


def vehicle_genes(options: SpaceOptions, paths: Sequence[NpcPath]) -> list[Gene]:
    """Returns the genes of an NPC vehicle that chooses from ``paths``.

    One with a fixed start has those of what it does only.
    """
    slices = range(options.slices)
    limit = max(float(path.path.route.speed_limits.max()) for path in paths)
    fastest = max(options.max_speed_factor * limit, options.min_speed)
    genes = []
    is_free = options.starts is VehicleStarts.FREE
    if is_free or options.optional:
        genes.append(presence(optional=options.optional))
    if is_free:
        genes += [
            choice("model", len(MODELS)),
            choice("path", len(paths)),
            number("start", 0.0, 1.0),
        ]
    genes += [number(f"speed_{k}", options.min_speed, fastest, "m/s") for k in slices]
    if options.slice_time > 0.0:
        if options.lane_changes:
            genes += [choice(f"manoeuvre_{k}", len(MANOEUVRES)) for k in slices]
    else:
        if options.lane_changes:
            leftmost = int(any(_neighbour(path.path, 1) for path in paths))
            rightmost = -int(any(_neighbour(path.path, -1) for path in paths))
            genes += [whole(f"lane_{k}", rightmost, leftmost) for k in slices]
        genes += [number(f"along_{k}", -MAX_SHIFT, MAX_SHIFT, "m") for k in slices]
    return genes + _driving_genes(options, is_free=is_free)


def _driving_genes(options: SpaceOptions, *, is_free: bool) -> list[Gene]:
    """Returns the genes of a vehicle's limits, and of where it stands."""
    genes = []
    most, most_aside = options.max_deceleration, options.max_lateral_acceleration
    if is_free and most > 0.0:
        genes.append(number("deceleration", min(LEAST_DECELERATION, most), most, "m/s²"))
    if is_free and most_aside > 0.0:
        least = min(LEAST_LATERAL_ACCELERATION, most_aside)
        genes.append(number("lateral_acceleration", least, most_aside, "m/s²"))
    if options.max_wait > 0.0:
        waits, at, seconds = WAITING
        genes += [
            whole(waits, 0, 1),
            choice(at, options.slices),
            number(seconds, 0.0, options.max_wait, "s"),
        ]
    return genes


def _neighbour(path: DrivenPath, side: int) -> bool:
    """Returns whether any lane of a path has a neighbour on a side."""
    lanes = [path.network.lanes[lane] for lane, _, _ in path.lane_ranges]
    return any((lane.left if side > 0 else lane.right) >= 0 for lane in lanes)
