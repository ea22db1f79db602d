"""Whether a party came into the way of another by taking its right of way just before."""

from __future__ import annotations

import numpy as np

from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.oracles.responsibility.junctions import find_signal, signal_is_red
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.scene import Scene

_ATTENTION = 4.0
"""Seconds after a party has left a junction in which its coming out of it counts, as for the oracle
``failure_to_yield``: by then the other could adapt to a vehicle that is simply ahead."""


def took_right_of_way(scene: Scene, ahead: Party, behind: Party) -> bool:
    """Returns whether a party came out of a junction before another that it had to let pass.

    Of two that came through the same junction into one lane (Vienna Convention, article 18; RSS,
    rule 3): the one that had to give way must not oblige the other to brake, even if that could.
    """
    if not scene.network.path.is_file():
        return False
    one, left = _last_movement(scene, ahead)
    if one is None or (ahead.count - 1 - left) * ahead.step_length > _ATTENTION:
        return False
    two, _ = _last_movement(scene, behind)
    if two is None or two.junction != one.junction:
        return False
    entered = {party: _entered(party, way) for party, way in ((ahead, one), (behind, two))}
    red = {
        party: _is_red(scene, party, way, entered[party])
        for party, way in ((ahead, one), (behind, two))
    }
    if red[ahead] != red[behind]:
        return red[ahead]
    yields = bool(set(one.yields_to) & set(two.lanes))
    return yields and not set(two.yields_to) & set(one.lanes)


def _last_movement(scene: Scene, party: Party) -> tuple[Movement | None, int]:
    """Returns the movement through the last junction that a party came to, and its last row."""
    table = right_of_way(scene.network).by_lane
    inside = [k for k, lane in enumerate(party.lanes.tolist()) if lane in table]
    if not inside:
        return None, -1
    return table[int(party.lanes[inside[-1]])], inside[-1]


def _entered(party: Party, way: Movement) -> int:
    return int(np.flatnonzero(np.isin(party.lanes, way.lanes))[0])


def _is_red(scene: Scene, party: Party, way: Movement, k: int) -> bool:
    link = find_signal(scene, way)
    return link is not None and signal_is_red(scene, link, party.step(k))
