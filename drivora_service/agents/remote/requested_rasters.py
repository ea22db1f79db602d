"""The ADS's side of rasters: it requests them when a run begins, and Drivora sends an image a step.

Needs NumPy only. Drivora draws, since it has the whole road network, and so that an ADS in any
language gets the same images.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from drivora_service.agents.interface import Observation
from drivora_service.agents.raster.raster_settings import (
    Raster,
    RasterSettings,
    check_out,
)
from drivora_service.agents.remote.protocol import MAX_RASTERS
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import ByteArray


class RequestedRasters:
    """The rasters that an ADS requests, and their images of the current step."""

    def __init__(self, channels: Iterable[str] = ()) -> None:
        """Requests nothing yet.

        Args:
            channels: Names of the channels that Drivora can draw.
        """
        self._channels = frozenset(channels)
        self._settings: list[RasterSettings] = []
        self._is_open = True
        self._step = -1
        self._images: Sequence[bytes] = ()

    def request(self, settings: RasterSettings) -> Raster:
        """Requests images; see ``ContextView.raster``."""
        if not self._is_open:
            raise AgentError("a raster was requested after setup_env; request it there")
        if len(self._settings) == MAX_RASTERS:
            raise AgentError(f"more than {MAX_RASTERS} rasters were requested; use fewer")
        missing = [c.label for c in settings.channels if c.label not in self._channels]
        if missing:
            can = ", ".join(sorted(self._channels)) or "no rasters at all"
            raise AgentError(
                f"this version of Drivora cannot draw {', '.join(missing)}; it draws: {can}"
            )
        self._settings.append(settings)
        return _RequestedRaster(self, len(self._settings) - 1, settings)

    def close(self) -> list[RasterSettings]:
        """Returns what was requested; later requests are refused."""
        self._is_open = False
        return self._settings

    def receive(self, step: int, images: Sequence[bytes]) -> None:
        """Takes the images of a step, one for each request."""
        self._step, self._images = step, images

    def image(self, number: int, step: int) -> bytes:
        """Returns an image.

        Args:
            number: Which request it answers.
            step: The step that the ADS means.

        Raises:
            AgentError: There is no such image now.
        """
        if step != self._step:
            raise AgentError(
                f"there is no image of step {step}: Drivora sends those of the current step, which "
                f"is {self._step}"
            )
        if number >= len(self._images):
            raise AgentError(f"Drivora sent {len(self._images)} images; needed: {number + 1}")
        return self._images[number]


class _RequestedRaster:
    def __init__(self, rasters: RequestedRasters, number: int, settings: RasterSettings) -> None:
        self._rasters, self._number, self._settings = rasters, number, settings

    @property
    def settings(self) -> RasterSettings:
        """What it shows."""
        return self._settings

    def draw(self, observation: Observation, out: ByteArray | None = None) -> ByteArray:
        """Returns the image that Drivora sent; see ``Raster.draw``."""
        image = self._rasters.image(self._number, observation.step)
        shape = self._settings.shape
        if len(image) != int(np.prod(shape)):
            raise AgentError(f"Drivora sent an image of {len(image)} bytes; needed: {shape}")
        pixels = np.frombuffer(image, dtype=np.uint8).reshape(shape)
        if out is None:
            return pixels.copy()
        check_out(out, self._settings)
        out[:] = pixels
        return out
