"""The actors of an episode: each has a row, and most have a body in SUMO."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.observations.trace import Actor, Role
from drivora_service.simulation.perception.actor_heights import actor_heights
from drivora_service.simulation.plans.episode_plan import EpisodePlan, FollowerPlan
from drivora_service.simulation.traffic import background
from drivora_service.simulation.traffic.sumo_traffic import Body


@dataclass(frozen=True, slots=True, kw_only=True)
class Cast:
    """The actors at the start of an episode, in order of their rows.

    Attributes:
        actors: Egos, followers, NPCs that SUMO drives, obstacles, background.
        heights: Height of each actor, metres.
        bodies: Bodies of the actors that the service moves.
        follower_rows: Rows of the plan's followers.
        obstacle_rows: Rows of the plan's obstacles.
    """

    actors: tuple[Actor, ...]
    heights: tuple[float, ...]
    bodies: tuple[Body, ...]
    follower_rows: tuple[int, ...]
    obstacle_rows: tuple[int, ...]


def cast_actors(plan: EpisodePlan) -> Cast:
    """Assigns a row to each actor of a plan."""
    actors: list[Actor] = []
    bodies: list[Body] = []

    def add(actor_id: str, role: Role, model: str, length: float, width: float) -> Actor:
        row = len(actors)
        actor = Actor(row=row, id=actor_id, role=role, model=model, length=length, width=width)
        actors.append(actor)
        return actor

    for ego in plan.egos:
        size = ego.model
        actor = add(ego.ego.id, Role.EGO, size.name, size.length, size.width)
        bodies.append(body_of(actor, ego.route.edges, on_lanes=True))
    first_follower = len(actors)
    for follower in plan.followers:
        actors.append(follower_actor(follower, len(actors)))
        bodies.append(follower_body(follower, actors[-1]))
    for driven in plan.driven:
        size = driven.model
        add(driven.id, Role.NPC_VEHICLE, size.name, size.length, size.width)
    first_obstacle = len(actors)
    for item in plan.obstacles:
        actor = add(item.obstacle.id, Role.NPC_OBSTACLE, item.model.name, item.length, item.width)
        bodies.append(body_of(actor, (item.edge,), on_lanes=False, is_fixed=True))
    flow = plan.scenario.background_traffic
    count = 0 if flow is None else flow.count
    for number in range(count):
        add(
            f"background:{number}",
            Role.BACKGROUND,
            background.MODEL,
            background.LENGTH,
            background.WIDTH,
        )
    return Cast(
        actors=tuple(actors),
        heights=actor_heights(plan),
        bodies=tuple(bodies),
        follower_rows=tuple(range(first_follower, first_follower + len(plan.followers))),
        obstacle_rows=tuple(range(first_obstacle, first_obstacle + len(plan.obstacles))),
    )


def follower_actor(plan: FollowerPlan, row: int) -> Actor:
    """Returns a follower as an actor."""
    return Actor(
        row=row,
        id=plan.id,
        role=plan.role,
        model=plan.model.name,
        length=plan.model.length,
        width=plan.model.width,
    )


def follower_body(plan: FollowerPlan, actor: Actor) -> Body:
    """Returns the body with which a follower enters SUMO; a vehicle that never drives is parked."""
    return body_of(actor, plan.edges, on_lanes=plan.on_lanes, is_fixed=plan.is_fixed)


def body_of(actor: Actor, edges: Sequence[str], *, on_lanes: bool, is_fixed: bool = False) -> Body:
    """Returns the body with which an actor that the service moves enters SUMO."""
    return Body(
        row=actor.row,
        id=actor.id,
        edges=tuple(edges),
        on_lanes=on_lanes,
        is_walker=actor.role is Role.NPC_WALKER,
        is_fixed=is_fixed,
        length=actor.length,
        width=actor.width,
    )
