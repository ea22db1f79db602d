"""Transformation between a document's frame and the road network's plane.

CARLA's y points south and its yaw turns clockwise from east; the network's y points north and
angles turn counter-clockwise. A network made from a CARLA town is moved by its offset, so that
``x = x_carla + offset_x``, ``y = -y_carla + offset_y`` and ``yaw = -yaw_carla``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameTransform:
    """The origin of a document in the network, and the direction of its y axis.

    Attributes:
        offset_x: Metres to add to the document's x.
        offset_y: Metres to add to the document's y once it points north.
        mirrored: True where the document's y points south and its yaw turns clockwise.
    """

    offset_x: float = 0.0
    offset_y: float = 0.0
    mirrored: bool = False

    def to_network(self, x: float, y: float) -> tuple[float, float]:
        """Returns the place in the network's plane, metres."""
        return x + self.offset_x, (-y if self.mirrored else y) + self.offset_y

    def yaw_to_network(self, degrees: float) -> float:
        """Returns radians counter-clockwise from east in [-pi, pi).

        Wrapped while still in degrees, which is exact, so that both frames yield the same numbers.
        Never minus zero, which equals zero but is written differently.
        """
        wrapped = math.remainder(-degrees if self.mirrored else degrees, 360.0)
        # The smallest numbers become zero only in the conversion, so add after it.
        return math.radians(-180.0 if wrapped == 180.0 else wrapped) + 0.0

    def yaw_from_network(self, radians: float) -> float:
        """Returns degrees in the document's sense of rotation, in [-180, 180]."""
        degrees = math.degrees(math.remainder(radians, math.tau))
        return 0.0 - degrees if self.mirrored else degrees
