"""The rules for an ego and a pedestrian."""

from __future__ import annotations

from drivora_service.observations.trace import Role
from drivora_service.oracles.responsibility.finding import Fault, Finding
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.junctions import signal_is_red
from drivora_service.oracles.responsibility.scene import ASTRAY, TOO_NEAR, Scene

_EXCESS = 0.05
"""Share of the limit up to which an ego does not count as speeding (as the oracle ``speeding``)."""


def walker(scene: Scene) -> Finding | None:
    """Applies the rules for pedestrians; None if the other is not a pedestrian."""
    if scene.other_role is not Role.NPC_WALKER:
        return None
    if scene.stands(scene.ego):
        return _make_finding(Fault.OTHER, "the ego stood")
    if not scene.areas.drivable_at(scene.impact.place, 0.3):
        return _make_finding(Fault.EGO, "the ego hit a pedestrian beside the road")
    if scene.astray(scene.ego) > ASTRAY:
        return _make_finding(Fault.EGO, "the ego drove in the lane of the other direction")
    if scene.impact.face is not Face.FRONT:
        return _make_finding(Fault.OTHER, "the pedestrian walked into the passing ego")
    # When it stepped on to the road: what its light showed then counts, and whether there was time.
    step = scene.other.step(_entry(scene))
    in_time = scene.could_brake(scene.ego, step)
    crossings = scene.areas.on_crossing(scene.other.place(scene.other.count - 1))
    links = [link for crossing in crossings if (link := _link(scene, crossing)) is not None]
    seconds = (scene.step - step) * scene.trace.step_length
    if not crossings or any(signal_is_red(scene, link, step) for link in links):
        if in_time:
            return _make_finding(
                Fault.EGO, f"the pedestrian had been in the road for {seconds:.1f} s"
            )
        if scene.other.from_beginning and step == 0:
            return Finding(rule="too_near", fault=Fault.UNKNOWN, reason=TOO_NEAR)
        if scene.too_fast_to_brake(scene.ego, step, _EXCESS):
            return _make_finding(
                Fault.EGO,
                f"the pedestrian had been in the road for {seconds:.1f} s, time enough at the "
                "speed limit",
            )
        return _make_finding(
            Fault.OTHER,
            f"the pedestrian came into the road {seconds:.1f} s before, too late to brake for",
        )
    # With a green light, whenever it came: the ego's was red.
    if in_time or links:
        return _make_finding(Fault.EGO, "the pedestrian was on a crossing")
    return _make_finding(
        Fault.UNKNOWN,
        f"the pedestrian came on to the crossing {seconds:.1f} s before, too late to brake for",
    )


def _entry(scene: Scene) -> int:
    """Returns the pedestrian's first row in the road."""
    other = scene.other
    road = scene.areas.road(scene.impact.place)
    for k in range(other.count - 1, -1, -1):
        if not other.boxes[k].intersects(road):
            return min(k + 1, other.count - 1)
    return 0


def _link(scene: Scene, crossing: int) -> tuple[str, int] | None:
    for lane in scene.network.lanes:
        for connection in lane.connections:
            if connection.to_lane == crossing and connection.traffic_light:
                return connection.traffic_light, connection.link_index
    return None


def _make_finding(fault: Fault, reason: str) -> Finding:
    return Finding(rule="pedestrian", fault=fault, reason=reason)
