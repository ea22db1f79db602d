"""An ADS that drives by a bird's-eye image: along the route's pixels, and not into those of others.

Besides the image it uses its own speed only. It drives in Drivora's process and in one of its own;
it does not give way at junctions.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.raster.raster_settings import LIMIT_STEP, Channel, RasterSettings

SETTINGS = RasterSettings(
    height=144,
    width=128,
    metres_per_pixel=0.4,
    ego_from_top=0.8,
    channels=(
        Channel.ROUTE,
        Channel.SPEED_LIMIT,
        Channel.VEHICLES,
        Channel.WALKERS,
        Channel.OBSTACLES,
        Channel.RED,
        Channel.YELLOW,
        Channel.STOP_SIGNS,
    ),
)
ROUTE, LIMIT, RED, YELLOW, STOP_SIGNS = map(
    SETTINGS.index,
    (Channel.ROUTE, Channel.SPEED_LIMIT, Channel.RED, Channel.YELLOW, Channel.STOP_SIGNS),
)
OTHERS = slice(SETTINGS.index(Channel.VEHICLES), SETTINGS.index(Channel.OBSTACLES) + 1)
AHEAD, LEFT, SCALE = SETTINGS.rows_ahead, SETTINGS.columns_left, SETTINGS.metres_per_pixel
REACH = math.ceil(2.2 / SCALE)
"""Pixels; in this radius, the middle of the route is searched."""
DISC = np.hypot(*np.mgrid[-REACH : REACH + 1, -REACH : REACH + 1]) <= REACH

WHEELBASE = 2.9
"""Metres."""
HALF_LENGTH = 2.5
"""Metres from the ego's centre to its bumper."""
STRIDE = 1.0
"""Metres between two points of the path."""
BRAKE, HARD_BRAKE = 1.5, 6.0
"""m/s², planned and possible."""
EASE = 0.8
"""m/s for each of the last metres before a halt."""
SIDE_ACCELERATION = 1.2
"""m/s² in bends."""
GAP = 3.0
"""Metres to another actor at a halt."""
SMOOTHING, JERK_STEP = 0.2, 0.1
"""Share of the wanted change of acceleration that is made in a step, and its bound in m/s²."""


class ImageDriver:
    """Finds its path in the image of the route, and the speed by what lies on this path."""

    def setup_env(self, context: Any) -> None:
        """Requests the images; called before every run."""
        self.raster = context.raster(SETTINGS)
        self.image = np.zeros(SETTINGS.shape, dtype=np.uint8)
        self.log = context.log
        self.log.declare("wanted_speed", "free_distance")
        self.acceleration = 0.0
        self.has_stopped = False

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Decides; called every step."""
        image, speed = self.raster.draw(observation, self.image), observation.speed
        path = find_path(image[ROUTE])
        free = min(
            distance_along(path, image[OTHERS].max(axis=0), 1.4) - GAP,
            self.distance_to_light(path, image, speed),
            self.distance_to_sign(path, image, speed),
            # The end of the route, or of the image.
            STRIDE * len(path),
        )
        wanted = min(halting_speed(free), speed_on(path, image[LIMIT]))
        self.log.row[:] = wanted, free
        change = min(2.0 * (wanted - speed), 1.2) - self.acceleration
        self.acceleration += min(max(SMOOTHING * change, -JERK_STEP), JERK_STEP)
        # All halts leave a metre.
        if speed * speed > 2.0 * HARD_BRAKE * max(free + 1.0, 0.1):
            self.acceleration = -HARD_BRAKE
        return AccelerationControl(self.acceleration, steer_along(path, speed))

    def distance_to_light(self, path: np.ndarray, image: np.ndarray, speed: float) -> float:
        """Returns the metres to the line of a light at which it must stop, and can."""
        free = math.inf
        for light, brake in ((RED, HARD_BRAKE), (YELLOW, 2.0 * BRAKE)):
            distance = distance_along(path, image[light], 1.0)
            # It stops a metre before the line, and must not start again there.
            if distance > speed * speed / (2.0 * brake) - 1.0:
                free = min(free, distance - 1.0)
        return free

    def distance_to_sign(self, path: np.ndarray, image: np.ndarray, speed: float) -> float:
        """Returns the metres to the next stop sign before which it has not stopped yet."""
        distance = distance_along(path, image[STOP_SIGNS], 1.0)
        if distance > 10.0:
            self.has_stopped = False
        elif speed < 0.03 and distance < 2.0:
            self.has_stopped = True
        return math.inf if self.has_stopped or distance < 0.0 else distance - 1.0


def pixel_of(ahead: float, left: float) -> tuple[int, int]:
    """Returns the row and the column of a place in the ego's frame, metres."""
    return round((AHEAD[0] - ahead) / SCALE), round((LEFT[0] - left) / SCALE)


def find_path(route: np.ndarray) -> np.ndarray:
    """Returns the (n, 2) middle of the route's pixels from the ego on, a point each metre."""
    place, direction = np.zeros(2), np.array([1.0, 0.0])
    path = []
    while len(path) < 45:
        row, column = pixel_of(*(place + STRIDE * direction))
        # The route's pixels in a disc around the place that is a stride further on.
        top, side = max(row - REACH, 0), max(column - REACH, 0)
        disc = route[top : row + REACH + 1, side : column + REACH + 1]
        if disc.shape != DISC.shape:
            break
        disc = disc * DISC
        in_rows, in_columns = disc.sum(axis=1), disc.sum(axis=0)
        count = in_rows.sum()
        if count < 10:
            break
        middle = np.array(
            [in_rows @ AHEAD[top : row + REACH + 1], in_columns @ LEFT[side : column + REACH + 1]]
        )
        step = middle / count - place
        # At the end of the pixels, their middle stays behind.
        if step @ direction < 0.3 * STRIDE:
            break
        direction = step / math.hypot(*step)
        place = place + STRIDE * direction
        path.append(place)
    return np.array(path).reshape(-1, 2)


def distance_along(path: np.ndarray, channel: np.ndarray, radius: float) -> float:
    """Returns the metres from the bumper to the channel's first pixels on the path, or inf.

    Args:
        path: The path.
        channel: (height, width) of the image.
        radius: Metres beside the path that count as on it.
    """
    rows, columns = np.nonzero(channel)
    if not len(rows) or not len(path):
        return math.inf
    there = np.column_stack((AHEAD[rows], LEFT[columns]))[:, None] - path
    gaps = np.hypot(there[..., 0], there[..., 1])
    nearest = gaps.argmin(axis=1)
    on_path = gaps.min(axis=1) <= radius
    if not on_path.any():
        return math.inf
    directions = np.diff(path, axis=0, prepend=np.zeros((1, 2)))[nearest] / STRIDE
    beyond = (there[np.arange(len(nearest)), nearest] * directions).sum(axis=1)
    along = STRIDE * (nearest + 1) + beyond - HALF_LENGTH
    return float(along[on_path].min())


def halting_speed(free: float) -> float:
    """Returns the speed from which the ego halts gently within a distance in metres, m/s."""
    eased = BRAKE / EASE**2
    if free < eased:
        return EASE * max(free, 0.0)
    return math.sqrt(2.0 * BRAKE * (free - 0.5 * eased))


def speed_on(path: np.ndarray, limits: np.ndarray) -> float:
    """Returns the speed from which the ego can brake for every limit and bend of the path, m/s."""
    if not len(path):
        return 0.0
    allowed = LIMIT_STEP * limits[tuple(np.transpose([pixel_of(*place) for place in path]))]
    allowed[allowed == 0.0] = math.inf
    # Of the pieces of 3 m before and behind a point: the sine of the angle between them.
    before, after = path[3:-3] - path[:-6], path[6:] - path[3:-3]
    turn = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) / (3.0 * STRIDE) ** 2
    bend = np.sqrt(SIDE_ACCELERATION * 3.0 * STRIDE / np.maximum(turn, 1e-3))
    allowed[3:-3] = np.minimum(allowed[3:-3], bend)
    distance = np.maximum(STRIDE * np.arange(len(path)) - HALF_LENGTH, 0.0)
    return float(np.sqrt(allowed**2 + 2.0 * BRAKE * distance).min())


def steer_along(path: np.ndarray, speed: float) -> float:
    """Returns the angle of the front wheels that leads to a point of the path, radians."""
    if not len(path):
        return 0.0
    ahead, left = path[min(round(max(4.0, 0.6 * speed) / STRIDE), len(path)) - 1]
    # From the rear axle, which follows the wheels without slip.
    ahead += 0.5 * WHEELBASE
    return math.atan(2.0 * WHEELBASE * left / max(ahead * ahead + left * left, 4.0))
