"""DiLu behind the protocol: decisions at 1 Hz, IDM between them."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from typing import Any

from drivora_service.agents.adapters.dilu.decisions import DECISIONS, Decision
from drivora_service.agents.adapters.dilu.driving import drive
from drivora_service.agents.adapters.dilu.endpoint import EndpointModel
from drivora_service.agents.adapters.dilu.experiences import Memory, read_experiences
from drivora_service.agents.adapters.dilu.models import ChatModel
from drivora_service.agents.adapters.dilu.operator_settings import read_endpoint_settings
from drivora_service.agents.adapters.dilu.prompts import question, system_message
from drivora_service.agents.adapters.dilu.reasoning import Driver
from drivora_service.agents.adapters.dilu.road import RouteFrame
from drivora_service.agents.adapters.dilu.situation import Beside, Situation
from drivora_service.agents.adapters.dilu.surroundings import Surroundings, look_around
from drivora_service.agents.adapters.forecast import LaneForecaster
from drivora_service.agents.adapters.lights import must_stop
from drivora_service.agents.interface import Control, Observation
from drivora_service.agents.remote.serving import serve
from drivora_service.agents.remote.views import ContextView

_EVERY_S = 1.0
_SPEED_STEP = 3.0
"""m/s by which a decision changes the desired speed."""

_HARD = 3.5
"""m/s² of braking that counts as the consequence of a mistake."""

_ROLLING = 1.0
"""m/s below which hard braking does not count as a mistake."""

_EXAMPLES, _MOST_EXAMPLES = 3, 5
_EMBEDDED_PATIENCE_S = 60.0

_LEAST_STAY, _STAY_S = 60.0, 6.0
"""Metres and seconds for which a lane must remain usable, to change to it."""

_LEAST_RETURN, _RETURN_S = 35.0, 4.0
"""Metres and seconds before the end of its use in which a lane is left."""

_COLUMNS = (
    "decision", "wanted_speed", "lane", "decisions", "like_nearest", "unclear", "unparsed",
    "impossible", "reflections", "corrected", "gained",
)  # fmt: skip


class DiluAdapter:
    """Lets a model decide, and executes its decisions."""

    def __init__(self, model: ChatModel, patience: float) -> None:
        """Args: patience: Seconds for all requests of a step."""
        self._model, self._patience = model, patience
        self._experiences = read_experiences()

    def setup_env(self, context: ContextView) -> None:
        """Makes the driver of a run, with the shipped memory.

        Raises:
            ValueError: The document's parameters are invalid for this agent.
        """
        examples = examples_in(context.parameters)
        self._context = context
        self._frame = RouteFrame(context)
        self._forecaster = LaneForecaster(context.lanes)
        self._model.begin_run()
        self._driver = Driver(
            model=self._model,
            memory=Memory(self._experiences),
            examples=examples,
            log=context.log,
        )
        self._wanted, self._lane = 0.0, 0
        self._decide_at: float | None = None
        self._decision = Decision.KEEP
        self._braked = 0.0
        self._near: float | None = None
        context.log.declare(*_COLUMNS)
        self._log_what_is_known()

    def run_step(self, observation: Observation) -> Control:
        """Decides, if a decision is due, and drives."""
        near = observation.route_s if self._near is None else self._near
        vehicle = self._context.vehicle
        around = look_around(observation, self._frame, self._forecaster, vehicle, near)
        self._near = around.s
        stop = None
        if must_stop(observation) and observation.light_distance < 1e6:
            stop = max(observation.light_distance, 0.0)
        if self._decide_at is None:
            self._decide_at, self._wanted = observation.time, around.speed
        # Half a step early instead of a whole one late, since times are sums of steps.
        if observation.time > self._decide_at - 0.5 * self._context.step_length:
            self._decide_at += _EVERY_S
            self._decide(around, stop)
        self._return_in_time(around)
        control = drive(
            around,
            self._frame,
            vehicle,
            wanted=self._wanted,
            offset=self._frame.offset(around.s, self._lane) or 0.0,
            stop=stop,
        )
        if around.speed > _ROLLING:
            self._braked = max(self._braked, -control.acceleration)
        self._write()
        return control

    def _decide(self, around: Surroundings, stop: float | None) -> None:
        until = time.monotonic() + self._patience
        if self._braked > _HARD:
            self._driver.reflect(self._braked, until)
        self._braked = 0.0
        situation = self._situation(around, stop)
        self._decision = self._driver.decide(situation, until)
        match self._decision:
            case Decision.ACCELERATE:
                wanted = max(self._wanted, around.speed) + _SPEED_STEP
                self._wanted = min(wanted, situation.allowed)
            case Decision.DECELERATE:
                self._wanted = max(min(self._wanted, around.speed) - _SPEED_STEP, 0.0)
            case Decision.LEFT:
                self._lane += 1
            case Decision.RIGHT:
                self._lane -= 1

    def _situation(self, around: Surroundings, stop: float | None) -> Situation:
        frame = self._frame
        here = frame.offset(around.s, self._lane) or 0.0
        low, high = min(around.d, here), max(around.d, here)
        return Situation(
            speed=around.speed,
            wanted=self._wanted,
            allowed=frame.allowed_speed(around.s, around.speed),
            ahead=around.ahead(low, high),
            left=self._beside(around, self._lane + 1),
            right=self._beside(around, self._lane - 1),
            stop=stop,
            crossing=around.crossing_distance(low, high),
        )

    def _beside(self, around: Surroundings, lane: int) -> Beside | None:
        offset = self._frame.offset(around.s, lane)
        needed = max(_STAY_S * around.speed, _LEAST_STAY)
        if offset is None or (lane and self._frame.room_beside(around.s, lane) < needed):
            return None
        return around.beside(offset)

    def _return_in_time(self, around: Surroundings) -> None:
        """Changes to the route's lane if the present lane will soon be unusable."""
        if self._lane == 0:
            return
        needed = max(_RETURN_S * around.speed, _LEAST_RETURN)
        if self._frame.room_beside(around.s, self._lane) < needed:
            self._context.log.event("back to the lane of the route")
            self._lane = 0

    def _log_what_is_known(self) -> None:
        log, reasons = self._context.log, self._model.reasons
        log.event(f"model: {self._model.name}")
        log.event(f"system message: {system_message(reasons=reasons).content!r}")
        for number, known in enumerate(self._experiences, start=1):
            told = question(known.situation, reasons=reasons).content
            log.event(f"experience {number}: {told} -> {known.decision}: {known.why}")

    def _write(self) -> None:
        counts = self._driver.counts
        self._context.log.row[:] = (
            DECISIONS.index(self._decision),
            self._wanted,
            self._lane,
            counts.decisions,
            counts.like_nearest,
            counts.unclear,
            counts.unparsed,
            counts.impossible,
            counts.reflections,
            counts.corrected,
            counts.gained,
        )


def examples_in(parameters: Mapping[str, Any]) -> int:
    """Returns the number of examples in the document.

    Raises:
        ValueError: The parameters are invalid for this agent.
    """
    given = dict(parameters)
    examples = given.pop("examples", _EXAMPLES)
    if given:
        raise ValueError(f"found the parameter {next(iter(given))!r}; allowed: examples")
    if (
        isinstance(examples, bool)
        or not isinstance(examples, int)
        or not 0 <= examples <= _MOST_EXAMPLES
    ):
        raise ValueError(
            f"found {examples!r} for the parameter 'examples'; allowed: a whole number from 0 to "
            f"{_MOST_EXAMPLES}"
        )
    return examples


def make_adapter() -> DiluAdapter:
    """Makes the agent with the operator's endpoint, or with the embedded model.

    Raises:
        ModelError: The settings are invalid, or the weights are missing.
    """
    settings = read_endpoint_settings(os.environ)
    if settings is not None:
        return DiluAdapter(EndpointModel(settings), settings.timeout)
    # It is installed only in the agent's own environment.
    from drivora_service.agents.adapters.dilu.embedded import EmbeddedModel

    return DiluAdapter(EmbeddedModel(), _EMBEDDED_PATIENCE_S)


if __name__ == "__main__":
    serve(make_adapter, name="dilu")
