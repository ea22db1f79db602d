"""What a bird's-eye raster shows, and how large; its frame.

Frame: the ego is at a constant place of the image and looks up. Row 0 is furthest ahead, column 0
furthest to the left. A pixel shows the place at its centre.

Needs NumPy only, as it is imported in the environments of ADSs, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Protocol

import numpy as np

from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import ByteArray, FloatArray

if TYPE_CHECKING:
    from drivora_service.agents.interface import Observation

LIMIT_STEP = 0.25
"""m/s that a value of 1 in the channel of speed limits stands for."""
MAX_SIDE = 1024
"""Maximum rows and columns."""
MAX_BYTES = 8 << 20
"""Maximum bytes of an image; what is sent to another process at each step must fit into a message.
"""
_MAX_HISTORY_S = 60.0


class Channel(IntEnum):
    """A channel of a raster: 255 where it applies and 0 elsewhere, but for the speed limit."""

    DRIVABLE = 0
    """Lanes that are open to cars, at their full width, and junctions."""
    CENTRE_LINES = 1
    """Of these lanes, also inside junctions."""
    BROKEN_LINES = 2
    """Borders to a lane of the same direction where a change is allowed."""
    SOLID_LINES = 3
    """Other borders of lanes: no change allowed, opposite direction, edge of the road."""
    SIGNAL_LINES = 4
    """Stop lines of lanes with a signal."""
    STOP_SIGNS = 5
    """Stop lines of lanes with a stop sign, or at an all-way stop."""
    GIVE_WAY_SIGNS = 6
    """Lines of lanes with a give-way sign."""
    SPEED_LIMIT = 7
    """The limit on the lane in steps of 0.25 m/s, 0 where no lane is; the highest of lanes that
    overlap."""
    ROUTE = 8
    """The route, as wide as its lanes."""
    RED = 9
    """The stop line of the next signal on the route, while it is red."""
    YELLOW = 10
    """The same while it is yellow."""
    GREEN = 11
    """The same while it is green."""
    VEHICLES = 12
    """Perceived vehicles."""
    WALKERS = 13
    """Perceived walkers."""
    OBSTACLES = 14
    """Perceived obstacles."""
    EGO = 15
    """The ego itself."""

    @property
    def label(self) -> str:
        """Name in texts and messages."""
        return self.name.lower()


HISTORIC = (Channel.VEHICLES, Channel.WALKERS, Channel.EGO)
"""Channels that are repeated for earlier times."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RasterSettings:
    """What a raster shows.

    Attributes:
        height: Rows.
        width: Columns.
        metres_per_pixel: Side of a pixel.
        ego_from_top: Place of the ego's centre, as a share of the height: 0 is the upper edge.
        ego_from_left: The same as a share of the width.
        channels: What is shown, in the order of the image's first axis.
        history: Seconds before now; each adds a channel for every one of ``VEHICLES``, ``WALKERS``
            and ``EGO`` that is chosen: where they were perceived then, seen from the ego's place
            now.
    """

    height: int = 128
    width: int = 128
    metres_per_pixel: float = 0.5
    ego_from_top: float = 0.75
    ego_from_left: float = 0.5
    channels: tuple[Channel, ...] = tuple(Channel)
    history: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Checks the values.

        Raises:
            AgentError: One of them is not allowed.
        """
        for name in ("height", "width"):
            side = getattr(self, name)
            if not (isinstance(side, int) and 1 <= side <= MAX_SIDE):
                raise _refused(name, side, f"1 to {MAX_SIDE} pixels")
        if not 0.0 < self.metres_per_pixel <= 100.0:
            raise _refused("metres_per_pixel", self.metres_per_pixel, "more than 0, at most 100")
        for name in ("ego_from_top", "ego_from_left"):
            share = getattr(self, name)
            if not 0.0 <= share <= 1.0:
                raise _refused(name, share, "0 to 1, a share of the image")
        known = [channel for channel in self.channels if channel in tuple(Channel)]
        if not self.channels or len(set(known)) < len(self.channels):
            allowed = ", ".join(f"Channel.{channel.name}" for channel in Channel)
            raise _refused("channels", self.channels, f"one or more, each once, of {allowed}")
        object.__setattr__(self, "channels", tuple(map(Channel, self.channels)))
        object.__setattr__(self, "history", tuple(map(float, self.history)))
        if not all(0.0 < before <= _MAX_HISTORY_S for before in self.history):
            allowed = f"seconds before now, more than 0 and at most {_MAX_HISTORY_S:g}"
            raise _refused("history", self.history, allowed)
        if math.prod(self.shape) > MAX_BYTES:
            allowed = f"channels * height * width of at most {MAX_BYTES}"
            raise _refused("size", " * ".join(map(str, self.shape)), allowed)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels in order; of earlier ones ``vehicles@-0.5``, with the seconds."""
        now = [channel.label for channel in self.channels]
        repeated = [channel for channel in self.channels if channel in HISTORIC]
        earlier = [f"{c.label}@-{before:g}" for before in self.history for c in repeated]
        return (*now, *earlier)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Channels, rows, columns."""
        repeated = sum(channel in HISTORIC for channel in self.channels)
        return len(self.channels) + repeated * len(self.history), self.height, self.width

    @property
    def rows_ahead(self) -> FloatArray:
        """(height,) metres that the centres of each row are ahead of the ego's centre."""
        rows = np.arange(0.5, self.height)
        return self.metres_per_pixel * (self.ego_from_top * self.height - rows)

    @property
    def columns_left(self) -> FloatArray:
        """(width,) metres that the centres of each column are to the left of the ego's centre."""
        columns = np.arange(0.5, self.width)
        return self.metres_per_pixel * (self.ego_from_left * self.width - columns)

    def index(self, channel: Channel) -> int:
        """Returns the place of a channel on the image's first axis.

        Raises:
            AgentError: The raster does not have it.
        """
        if channel not in self.channels:
            has = ", ".join(own.label for own in self.channels)
            raise AgentError(f"the raster has no channel {channel.label!r}; it has: {has}")
        return self.channels.index(channel)


class Raster(Protocol):
    """Draws images of what an ego observes, in the process of the ADS or beside it."""

    @property
    def settings(self) -> RasterSettings:
        """What it shows."""
        ...

    def draw(self, observation: Observation, out: ByteArray | None = None) -> ByteArray:
        """Returns the image of the current step.

        Call it at every step if the raster has a history: earlier images are made of what it was
        given.

        Args:
            observation: Observation of this step.
            out: (channels, height, width), filled and returned; without it, a new array.

        Raises:
            AgentError: ``out`` has another shape or type.
        """
        ...


def check_out(out: ByteArray, settings: RasterSettings) -> None:
    """Checks an array that is to be filled.

    Raises:
        AgentError: It has another shape, type or order, or is read-only.
    """
    fits = out.shape == settings.shape and out.dtype == np.uint8
    if not (fits and out.flags.c_contiguous and out.flags.writeable):
        raise AgentError(
            f"out is an array of {out.dtype} with the shape {out.shape}; needed: uint8, "
            f"{settings.shape}, contiguous and writeable"
        )


def _refused(name: str, found: object, allowed: str) -> AgentError:
    return AgentError(f"RasterSettings: {name} is {found!r}; allowed: {allowed}")
