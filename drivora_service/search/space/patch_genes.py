"""Genes of a slippery patch on an ego's way, and their decoding."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.model import FrictionPatch
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.driven_path import Pose
from drivora_service.search.space.ego_genes import PlacedEgo
from drivora_service.search.space.layout import choice, number, presence
from drivora_service.search.space.space_options import SpaceOptions

AHEAD_OF_EGO = 5.0
"""Metres ahead of an ego's start where the first patch has its centre."""
MAX_LATERAL = 1.5
"""Metres from the lane's centre: less than half a lane, so that every patch covers the road."""
LENGTHS = (2.0, 30.0)
WIDTHS = (1.0, 8.0)
"""Metres: from a puddle in a rut to the surface of two lanes."""
FRICTIONS = (0.05, 0.6)
"""From wet ice to a wet, smooth road."""
_DIGITS = 3


def patch_genes(options: SpaceOptions, egos: int) -> list[Gene]:
    """Returns the genes of a patch."""
    return [
        presence(optional=options.optional),
        choice("path", egos),
        number("place", 0.0, 1.0),
        number("lateral", -MAX_LATERAL, MAX_LATERAL, "m"),
        number("length", *LENGTHS, "m"),
        number("width", *WIDTHS, "m"),
        number("friction", *FRICTIONS),
    ]


class PatchDecoder:
    """Reads one patch's genes."""

    def __init__(self, block: Block, patch_id: str) -> None:
        self.block, self._id = block, patch_id
        self._present = block.start
        self._path, self._place = block.index("path"), block.index("place")
        self._lateral, self._friction = block.index("lateral"), block.index("friction")
        self._length, self._width = block.index("length"), block.index("width")

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the patch is present."""
        return bool(values[self._present] > 0.5)

    def pose(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Pose:
        """Returns its centre, and the direction of its length."""
        ego = egos[int(values[self._path]) % len(egos)]
        begin = min(ego.s + AHEAD_OF_EGO, ego.route.path.length)
        s = begin + float(values[self._place]) * (ego.route.path.length - begin)
        return ego.route.path.at(s).beside(float(values[self._lateral]))

    def decode_part(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Decoded:
        """Returns the patch, as ``alike`` compares them."""
        return (self.patch(egos, values), None) if self.is_present(values) else ABSENT

    def patch(self, egos: Sequence[PlacedEgo], values: FloatArray) -> FrictionPatch:
        """Returns the patch."""
        return FrictionPatch(
            id=self._id,
            location=self.pose(egos, values).waypoint(),
            length=round(float(values[self._length]), _DIGITS),
            width=round(float(values[self._width]), _DIGITS),
            friction=round(float(values[self._friction]), _DIGITS),
        )
