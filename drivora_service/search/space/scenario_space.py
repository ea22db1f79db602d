"""The scenarios that a campaign searches: a seed scenario and its variable parts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property, partial

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.route_meetings import meeting_matrix
from drivora_service.scenario.model import Scenario
from drivora_service.search.genes import Block, GeneSpace, Part
from drivora_service.search.space.alike import Decode, decode_alike
from drivora_service.search.space.condition_genes import (
    light_genes,
    traffic_lights,
    weather,
    weather_genes,
)
from drivora_service.search.space.driven_path import Pose
from drivora_service.search.space.ego_genes import FixedEgo, GeneEgo, PlacedEgo, ego_genes
from drivora_service.search.space.ego_routes import routes_of_egos
from drivora_service.search.space.layout import Layout
from drivora_service.search.space.obstacle_genes import ObstacleDecoder, blocks_lane, obstacle_genes
from drivora_service.search.space.option_checks import check_options
from drivora_service.search.space.patch_genes import PatchDecoder, patch_genes
from drivora_service.search.space.repair import Mover, other_choices, settle
from drivora_service.search.space.seed_actors import ActorNames, seed_starts
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts
from drivora_service.search.space.vehicles.fixed_starts import choose_fixed_starts
from drivora_service.search.space.vehicles.npc_paths import NpcPath, find_npc_paths
from drivora_service.search.space.vehicles.vehicle_decoding import VehicleDecoder
from drivora_service.search.space.vehicles.vehicle_genes import vehicle_genes
from drivora_service.search.space.vehicles.vehicle_places import GenePlaces, VehiclePlace
from drivora_service.search.space.vehicles.vehicle_ways import VehicleWay
from drivora_service.search.space.walker_genes import WalkerDecoder, walker_genes


class ScenarioSpace:
    """Turns genes into scenarios around a seed scenario.

    The same seed, network and options give the same space: the same values mean the same scenario.

    Attributes:
        seed: The seed scenario.
        network: Its road network.
        options: Its variable parts.
        genes: All genes with their bounds.
        routes: The routes that egos choose from; with one ego, the seed's.
        paths: The paths that NPC vehicles choose from.
    """

    def __init__(self, seed: Scenario, network: RoadNetwork, options: SpaceOptions) -> None:
        """Creates the space of genes around a seed scenario.

        Raises:
            SearchError: The options contradict one another or the seed, or there is no place
                around the seed's egos for the variable actors.
        """
        check_options(seed, options)
        self.seed, self.network, self.options = seed, network, options
        self.routes = routes_of_egos(seed, network, options)
        self.paths: tuple[NpcPath, ...] = ()
        if options.vehicles:
            ways = [route.path for route in self.routes]
            self.paths = find_npc_paths(
                network,
                ways,
                reach=options.reach,
                count=options.paths,
                region=seed.map_region.region_segment,
            )
        self._seed_starts = seed_starts(seed, network)
        self._layout, self._names = Layout(), ActorNames(seed)
        self._fixed_egos, self._egos = self._make_egos()
        self._vehicles = self._make_vehicles()
        self._walkers = self._make_walkers()
        self._obstacles = self._make_obstacles()
        self._patches = self._make_patches()
        self._weather = (
            self._layout.add("weather", Part.WEATHER, weather_genes()) if options.weather else None
        )
        self._lights = (
            self._layout.add("lights", Part.LIGHTS, light_genes())
            if options.lights and network.programs
            else None
        )
        self.genes = GeneSpace(self._layout.blocks)

    @cached_property
    def conflicts(self) -> BoolArray | None:
        """(n, n) which routes meet in a junction; ``None`` if the egos' routes do not vary."""
        if self.options.egos == 1:
            return None
        return meeting_matrix(self.network, [route.path.route.line for route in self.routes])

    def repair(self, values: FloatArray) -> FloatArray:
        """Clips values to the bounds and moves actors apart that would start too near.

        Args:
            values: (d,) genes; not changed.

        Returns:
            (d,) genes. Repairing them again changes nothing. An actor without a free place is not
            moved: :func:`scenario_problems` checks whether the scenario is valid nevertheless.
        """
        repaired = self.genes.clip(values)
        taken = [*self._seed_starts, *(ego.place().start for ego in self._fixed_egos)]
        taken += [
            vehicle.start(repaired)
            for vehicle in self._vehicles
            if vehicle.genes is None and vehicle.is_present(repaired)
        ]
        for mover in self._ego_and_vehicle_movers(repaired):
            settle(repaired, mover, taken)
        egos = self._place_egos(repaired)
        for mover in self._roadside_movers(repaired, egos):
            settle(repaired, mover, taken)
        return repaired

    def scenario(self, values: FloatArray) -> Scenario:
        """Returns the scenario that values (d,) within the bounds encode."""
        egos = self._place_egos(values)
        seed = self.seed
        return replace(
            seed,
            ego_vehicles=tuple(ego.ego for ego in egos),
            npc_vehicles=seed.npc_vehicles
            + tuple(one.vehicle(values) for one in self._vehicles if one.is_present(values)),
            npc_walkers=seed.npc_walkers
            + tuple(one.walker(egos, values) for one in self._walkers if one.is_present(values)),
            npc_obstacles=seed.npc_obstacles
            + tuple(
                one.obstacle(egos, values) for one in self._obstacles if one.is_present(values)
            ),
            friction_patches=seed.friction_patches
            + tuple(one.patch(egos, values) for one in self._patches if one.is_present(values)),
            weather=seed.weather
            if self._weather is None
            else weather(self._weather, values, seed.weather),
            traffic_lights=seed.traffic_lights
            if self._lights is None
            else traffic_lights(self._lights, values, seed.traffic_lights),
        )

    def decode_alike(self, one: FloatArray, other: FloatArray) -> bool:
        """Returns whether two candidates cannot be told apart by their runs; see ``alike``.

        Args:
            one: (d,) repaired genes.
            other: (d,) genes within the bounds.
        """
        return decode_alike(self._parts(one), one, other)

    def _parts(self, base: FloatArray) -> tuple[tuple[Block, Decode], ...]:
        """Returns the blocks, with what decodes them beside the egos of a candidate."""
        egos = self._place_egos(base)
        parts: list[tuple[Block, Decode]] = [(one.block, one.decode_part) for one in self._egos]
        parts += [(one.block, one.decode_part) for one in self._vehicles]
        parts += [(one.block, partial(one.decode_part, egos)) for one in self._walkers]
        parts += [(one.block, partial(one.decode_part, egos)) for one in self._obstacles]
        parts += [(one.block, partial(one.decode_part, egos)) for one in self._patches]
        seed = self.seed
        if (of_weather := self._weather) is not None:
            parts.append((of_weather, lambda v: (weather(of_weather, v, seed.weather), None)))
        if (lights := self._lights) is not None:
            parts.append((lights, lambda v: (traffic_lights(lights, v, seed.traffic_lights), None)))
        return tuple(parts)

    def vehicle_ways(self, values: FloatArray) -> tuple[VehicleWay, ...]:
        """Returns the ways of the NPC vehicles that are present, from repaired values (d,)."""
        return tuple(one.way(values) for one in self._vehicles if one.is_present(values))

    def ego_distance(self, block: Block, values: FloatArray) -> float | None:
        """Returns how far from an ego's start an actor appears, or a patch has its centre.

        Args:
            block: The genes of an actor or patch, which counts as present.
            values: (d,) genes within the bounds.

        Returns:
            Metres to the nearest ego; ``None`` for egos, weather and lights.
        """
        egos = self._place_egos(values)
        pose = self._pose_of(block, egos, values)
        if pose is None:
            return None
        return min(math.hypot(pose.x - e.start.pose.x, pose.y - e.start.pose.y) for e in egos)

    def _pose_of(
        self, block: Block, egos: tuple[PlacedEgo, ...], values: FloatArray
    ) -> Pose | None:
        place = block.start
        for vehicle in self._vehicles:
            if vehicle.block.start == place:
                return vehicle.start(values).pose
        for walker in self._walkers:
            if walker.block.start == place:
                return walker.start(egos, values).pose
        for obstacle in self._obstacles:
            if obstacle.block.start == place:
                return obstacle.start(egos, values).pose
        for patch in self._patches:
            if patch.block.start == place:
                return patch.pose(egos, values)
        return None

    def _make_egos(self) -> tuple[tuple[FixedEgo, ...], tuple[GeneEgo, ...]]:
        own = self.seed.ego_vehicles
        if self.options.egos == 1:
            pairs = zip(own, self.routes, strict=True)
            return tuple(FixedEgo(ego, route) for ego, route in pairs), ()
        egos = []
        for i in range(self.options.egos):
            name = f"ego_{i}"
            genes = ego_genes(self.options, i, len(self.routes))
            like = own[i] if i < len(own) else replace(own[0], id=self._names.take_name(name))
            block = self._layout.add(name, Part.EGO, genes, like.id)
            egos.append(GeneEgo(block, like, self.routes))
        return (), tuple(egos)

    def _make_vehicles(self) -> tuple[VehicleDecoder, ...]:
        made = []
        fixed = self._make_fixed_starts()
        for i in range(self.options.vehicles):
            name = f"vehicle_{i}"
            genes = vehicle_genes(self.options, (fixed[i].path,) if fixed else self.paths)
            block = self._layout.add(name, Part.VEHICLE, genes, self._names.take_name(name))
            place = fixed[i] if fixed else GenePlaces(block, self.paths)
            made.append(VehicleDecoder(block, block.actor, place, self.options))
        return tuple(made)

    def _make_fixed_starts(self) -> tuple[VehiclePlace, ...]:
        """Returns the starts of NPC vehicles, if they do not vary."""
        options = self.options
        if options.starts is VehicleStarts.FREE or not options.vehicles:
            return ()
        ego, *others = (ego.place().start for ego in self._fixed_egos)
        limit = max(float(one.path.route.speed_limits.max()) for one in self.paths)
        return choose_fixed_starts(
            self.paths,
            ego,
            [*others, *self._seed_starts],
            options.vehicles,
            options.max_speed_factor * limit,
        )

    def _make_walkers(self) -> tuple[WalkerDecoder, ...]:
        made = []
        for i in range(self.options.walkers):
            name = f"walker_{i}"
            genes = walker_genes(self.options, self._ego_count)
            block = self._layout.add(name, Part.WALKER, genes, self._names.take_name(name))
            made.append(WalkerDecoder(block, block.actor))
        return tuple(made)

    def _make_obstacles(self) -> tuple[ObstacleDecoder, ...]:
        made = []
        for i in range(self.options.obstacles):
            name = f"obstacle_{i}"
            genes = obstacle_genes(self.options, self._ego_count)
            block = self._layout.add(name, Part.OBSTACLE, genes, self._names.take_name(name))
            made.append(ObstacleDecoder(block, block.actor))
        return tuple(made)

    def _make_patches(self) -> tuple[PatchDecoder, ...]:
        made = []
        for i in range(self.options.patches):
            name = f"patch_{i}"
            genes = patch_genes(self.options, self._ego_count)
            block = self._layout.add(name, Part.PATCH, genes, self._names.take_name(name))
            made.append(PatchDecoder(block, block.actor))
        return tuple(made)

    @property
    def _ego_count(self) -> int:
        return len(self._fixed_egos) + len(self._egos)

    def _place_egos(self, values: FloatArray) -> tuple[PlacedEgo, ...]:
        own = tuple(ego.place() for ego in self._fixed_egos)
        return own + tuple(ego.place(values) for ego in self._egos if ego.is_present(values))

    def _ego_and_vehicle_movers(self, values: FloatArray) -> Iterator[Mover]:
        for ego in self._egos:
            if ego.is_present(values):
                yield Mover(
                    start=ego.start,
                    room=ego.shift_room,
                    shift_gene=ego.shift_gene,
                    alternatives=other_choices(ego.path_gene, values, len(self.routes)),
                )
        for vehicle in self._vehicles:
            genes = vehicle.genes
            if genes is not None and vehicle.is_present(values):
                yield Mover(
                    start=vehicle.start,
                    room=genes.shift_room,
                    shift_gene=genes.shift_gene,
                    alternatives=other_choices(genes.path_gene, values, len(self.paths)),
                )

    def _roadside_movers(self, values: FloatArray, egos: tuple[PlacedEgo, ...]) -> Iterator[Mover]:
        for obstacle in self._obstacles:
            if obstacle.is_present(values):
                yield Mover(
                    start=partial(obstacle.start, egos),
                    room=partial(obstacle.shift_room, egos),
                    shift_gene=obstacle.shift_gene,
                    alternatives=obstacle.other_sides(values),
                    is_refused=lambda start: blocks_lane(start, egos),
                )
        for walker in self._walkers:
            if walker.is_present(values):
                yield Mover(
                    start=partial(walker.start, egos),
                    room=partial(walker.shift_room, egos),
                    shift_gene=walker.shift_gene,
                )
