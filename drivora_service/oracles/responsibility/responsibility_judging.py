"""The table of rules, in the order in which they are applied."""

from __future__ import annotations

from collections.abc import Callable

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Actor, Role, Trace
from drivora_service.oracles.responsibility.beside_rules import side_by_side
from drivora_service.oracles.responsibility.finding import Fault, Finding
from drivora_service.oracles.responsibility.following_rules import one_behind_the_other
from drivora_service.oracles.responsibility.impact import Face, Impact
from drivora_service.oracles.responsibility.junction_rules import in_junction
from drivora_service.oracles.responsibility.lane_areas import lane_areas
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.road_rules import across, opposite_directions
from drivora_service.oracles.responsibility.scene import Scene
from drivora_service.oracles.responsibility.walker_rules import walker


def appeared(scene: Scene) -> Finding | None:
    """The other was placed where no motion led."""
    if scene.impact.jumped:
        return Finding(rule="appeared", fault=Fault.OTHER, reason="the other jumped into the ego")
    if not scene.impact.appeared:
        return None
    return Finding(
        rule="appeared", fault=Fault.OTHER, reason="the other appeared where the ego was"
    )


def backwards(scene: Scene) -> Finding | None:
    """An ego that goes backwards is responsible."""
    if scene.impact.face is Face.REAR and scene.impact.ego_forward < -scene.standing_speed:
        return Finding(rule="backwards", fault=Fault.EGO, reason="the ego went backwards")
    return None


def both_stand(scene: Scene) -> Finding | None:
    """Neither party moved."""
    if scene.stands(scene.ego) and scene.stands(scene.other):
        return Finding(rule="standing", fault=Fault.OTHER, reason="the ego stood")
    return None


def off_the_road(scene: Scene) -> Finding | None:
    """Beside the road the party that moves is responsible; undetermined where both left it."""
    if scene.areas.drivable_at(scene.impact.place, 0.3):
        return None
    if scene.stands(scene.ego):
        return Finding(rule="off_the_road", fault=Fault.OTHER, reason="the ego stood")
    if scene.stands(scene.other):
        return Finding(
            rule="off_the_road", fault=Fault.EGO, reason="the ego left the road, the other stood"
        )
    beside = [party for party in (scene.ego, scene.other) if party.lanes[-1] < 0]
    if len(beside) == 1:
        return Finding(
            rule="off_the_road",
            fault=scene.fault_of(beside[0]),
            reason=f"{scene.name(beside[0])} was beside the road",
        )
    return Finding(rule="off_the_road", fault=Fault.UNKNOWN, reason="both were beside the road")


def obstacle(scene: Scene) -> Finding | None:
    """Hitting an object that stands is judged in the same way for all directions."""
    return one_behind_the_other(scene) if scene.other_role is Role.NPC_OBSTACLE else None


TABLE: tuple[Callable[[Scene], Finding | None], ...] = (
    appeared,
    backwards,
    both_stand,
    walker,
    off_the_road,
    obstacle,
    in_junction,
    opposite_directions,
    across,
    one_behind_the_other,
    side_by_side,
)
"""The first rule that applies decides: what needs no lanes comes first.

Pedestrians come before the edge of the road, which has another meaning for them, and what stands
before junctions, as it has no way to give. In a junction the ways cross: the rules of right of way
come before how the two faced each other. The rest goes from what few collisions are to what all
may be.
"""


def find_responsible(
    trace: Trace,
    network: RoadNetwork,
    ego: Actor,
    other: Actor,
    step: int,
    impact: Impact,
    standing_speed: float,
) -> Finding:
    """Finds the responsible party of a collision.

    Args:
        trace: The run.
        network: Its road network.
        ego: The ego.
        other: The other actor.
        step: Row of the trace at the contact.
        impact: The impact.
        standing_speed: m/s up to which an actor stands.
    """
    scene = Scene(
        trace=trace,
        network=network,
        areas=lane_areas(network),
        step=step,
        ego=Party(trace, network, ego, step, impact.ego_speed),
        other=Party(trace, network, other, step, impact.other_speed),
        impact=impact,
        standing_speed=standing_speed,
    )
    for rule in TABLE:
        found = rule(scene)
        if found is not None:
            return found
    return Finding(rule="none", fault=Fault.UNKNOWN, reason="no rule applies")
