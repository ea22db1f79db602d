"""The vehicles of the background traffic: they enter, get longer routes, and are replaced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.simulation.sumo import DrivenActor, SumoWorld
from drivora_service.simulation.traffic.background import LENGTH, WIDTH, Wanderers

_CHECK_STEPS = 20
_EDGES_LEFT = 4


class BackgroundVehicles:
    """The background traffic of a run.

    Attributes:
        start_time: Seconds.
    """

    def __init__(
        self,
        wanderers: Wanderers,
        rows: Sequence[tuple[int, str]],
        *,
        clear: FloatArray,
        start_time: float,
        driver: str,
    ) -> None:
        """Describes the traffic.

        Args:
            wanderers: Draws entries and routes.
            rows: (row, id) of each vehicle.
            clear: (n, 2) places where no vehicle may enter, metres: the starts of the egos.
            start_time: Seconds.
            driver: SUMO's driver, a vehicle type.
        """
        self._wanderers = wanderers
        self._rows = tuple(rows)
        self._clear = clear
        self.start_time = start_time
        self._driver = driver
        self._tended = False

    def is_due(self, time: float) -> bool:
        """Returns whether the traffic has started at ``time`` seconds."""
        return time >= self.start_time - 1e-9

    def tend(
        self,
        sumo: SumoWorld,
        driven: list[DrivenActor],
        step: int,
        frame: FloatArray,
        present: BoolArray,
    ) -> None:
        """Adds missing vehicles and extends routes that run out.

        Args:
            sumo: The simulation in SUMO.
            driven: All vehicles that SUMO drives; changed.
            step: Row of the frame.
            frame: (N, 9) the next frame, without the vehicles that SUMO drives.
            present: (N,) of that frame.
        """
        if self._tended and step % _CHECK_STEPS:
            return
        self._tended = True
        by_row = {actor.row: actor for actor in driven}
        known = sumo.known_ids()
        taken = np.concatenate((self._clear, frame[present, :2]))
        for row, vehicle in self._rows:
            if row not in by_row:
                place = self._wanderers.draw_entry(taken)
                if place is None:
                    continue
                lane, s = place
                x, y, _ = lane.position_at(s)
                taken = np.concatenate((taken, [(x, y)]))
                driven.append(
                    sumo.add_driven(
                        row,
                        vehicle,
                        self._wanderers.draw_route(lane.edge_id),
                        driver=self._driver,
                        length=LENGTH,
                        width=WIDTH,
                        lane_number=lane.lane_number,
                        position=s,
                        arrival=None,
                    )
                )
            elif vehicle not in known:
                driven.remove(by_row[row])
            elif sumo.count_remaining_edges(vehicle) < _EDGES_LEFT:
                more = self._wanderers.draw_route(sumo.last_edge(vehicle))[1:]
                if more:
                    sumo.extend_route(vehicle, more)
