"""nuPlan's rule of fault for collisions, for its metric and for comparison with the table."""

from __future__ import annotations

from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol
from drivora_service.oracles.responsibility.impact import Face, Impact


def at_fault(
    ego: EgoView, k: int, impact: Impact, *, standing_speed: float, off_road: float
) -> bool:
    """Returns whether the ego is at fault by nuPlan's rule (Karnchanachari et al. 2024).

    It is if it hit something that stood, if its front hit the other, or if it was touched at its
    side while it straddled lanes or was off the road. It is not if it stood, or if it was hit from
    behind, unless it went backwards. Inside junctions, where lanes overlap and bend, reaching over
    the edge of a lane does not count.

    Args:
        ego: The ego.
        k: Its row at the contact.
        impact: The contact.
        standing_speed: m/s up to which an actor stands.
        off_road: Metres outside the drivable area from which on the ego is off the road.
    """
    if impact.ego_speed <= standing_speed or impact.appeared:
        return False
    if impact.other_speed <= standing_speed or impact.face is Face.FRONT:
        return True
    if impact.face is Face.REAR:
        return impact.ego_forward < -standing_speed
    return is_beside_lane(ego, k, off_road)


def is_beside_lane(ego: EgoView, k: int, off_road: float) -> bool:
    """Returns whether the ego reaches over the edge of its lane, or is off the road.

    Args:
        ego: The ego.
        k: Its row.
        off_road: Metres outside the drivable area from which on the ego is off the road.
    """
    return bool(ego.lanes[k] < 0 or ego.outside[k] > off_road or _straddles(ego, k))


def _straddles(ego: EgoView, k: int) -> bool:
    if ego.in_junction[k]:
        return False
    lateral = abs(float(ego.value(EgoCol.LANE_LATERAL)[k]))
    return bool(lateral + ego.lateral_reach[k] > ego.lane_half_widths[k])
