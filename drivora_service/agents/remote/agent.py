"""An ADS with its own process, as an agent."""

from __future__ import annotations

import uuid
from collections.abc import Sequence

import grpc
import numpy as np

from drivora_service.agents.interface import AgentContext, Control, Observation
from drivora_service.agents.log import MOST_PLAN_POINTS, AgentLog
from drivora_service.agents.manifest import AgentDeadlines
from drivora_service.agents.raster.raster_settings import Raster
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.hosts import Host
from drivora_service.agents.remote.remote_messages import (
    control_of,
    invalid,
    requested_rasters,
    setup_request,
    step_request,
)
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import ByteArray

_DETAILS = 8000
_MOST_NAMES, _LONGEST_NAME = 1000, 200
_LOG_CHARACTERS = 16 << 20
"""Maximum characters of an ADS in a run's log."""
_LINE = 64
"""Additional characters that count for each line."""


class RemoteAgent:
    """Drives one ego of one run; its ADS is kept for the next."""

    def __init__(self, name: str, host: Host, deadlines: AgentDeadlines) -> None:
        """Args: deadlines: Deadlines of the calls; an ADS that misses one is ended."""
        self._name, self._host, self._deadlines = name, host, deadlines
        self._run = uuid.uuid4().hex
        self._ego = ""
        self._log = AgentLog()
        self._columns: dict[str, int] = {}
        self._room = _LOG_CHARACTERS
        self._rasters: tuple[tuple[Raster, ByteArray], ...] = ()

    def setup_env(self, context: AgentContext) -> None:
        """Sends the context of a run to the ADS, and prepares the log and images that it wants.

        Raises:
            AgentError: The ADS failed, died, hung or answered garbage.
        """
        self._ego, self._log = context.ego_id, context.log
        request, timeout = setup_request(context, self._run), self._deadlines.setup
        try:
            reply = self._host.connection.setup(request, timeout)
            self._columns = _columns(reply.log_names)
            wanted = requested_rasters(reply)
        except (grpc.RpcError, AgentError) as error:
            raise self._handle_failure("SetupEnv", timeout, error) from error
        self._log.declare(*self._columns)
        self._write(reply.text)
        self._rasters = tuple(
            (context.raster(settings), np.zeros(settings.shape, dtype=np.uint8))
            for settings in wanted
        )

    def run_step(self, observation: Observation) -> Control:
        """Requests a control; raises as :meth:`setup_env`."""
        images = [raster.draw(observation, out).tobytes() for raster, out in self._rasters]
        request = step_request(observation, self._run, images)
        timeout = self._deadlines.step
        try:
            reply = self._host.connection.step(request, timeout)
            self._record(reply)
            return control_of(reply)
        except (grpc.RpcError, AgentError) as error:
            where = f"RunStep at {observation.time:.2f} s"
            raise self._handle_failure(where, timeout, error) from error

    def _record(self, reply: pb.StepReply) -> None:
        row = self._log.row
        row.fill(np.nan)
        for name, value in reply.values.items():
            column = self._columns.get(name)
            if column is None:
                raise AgentError(
                    f"the ADS logs {name!r}; SetupEnv declared: "
                    f"{', '.join(self._columns) or 'nothing'}",
                    cause="agent_invalid_control",
                )
            row[column] = value
        self._write(reply.text)
        if len(reply.plan) % 2 or len(reply.plan) > 2 * MOST_PLAN_POINTS:
            raise AgentError(
                f"the ADS tells a plan of {len(reply.plan)} numbers; allowed: x and y of at most "
                f"{MOST_PLAN_POINTS} points",
                cause="agent_invalid_control",
            )
        if reply.plan:
            self._log.plan(np.array(reply.plan).reshape(-1, 2))

    def _write(self, text: str) -> None:
        if self._room <= 0:
            return
        for line in text.splitlines():
            self._room -= len(line) + _LINE
            if self._room <= 0:
                self._log.event("[the log is full]")
                return
            self._log.event(line)

    def _handle_failure(
        self, where: str, timeout: float, error: grpc.RpcError | AgentError
    ) -> AgentError:
        """Returns the error of a failed call; an ADS that hangs or cannot be reached is ended."""
        subject = f"agent {self._name!r} of ego {self._ego!r}"
        if isinstance(error, AgentError):
            return AgentError(
                f"{subject} in {where}: {error}", cause=error.cause, log=self._host.tail()
            )
        code, details = error.code(), str(error.details() or "")[:_DETAILS]
        match code:
            case grpc.StatusCode.DEADLINE_EXCEEDED:
                cause = "agent_hung"
                message = f"{subject} did not answer {where} within {timeout:g} s"
            case grpc.StatusCode.UNAVAILABLE | grpc.StatusCode.CANCELLED:
                ended = self._host.describe_end()
                cause = self._host.death if ended else "agent_unreachable"
                message = f"{subject} {ended or f'cannot be reached: {details}'}, in {where}"
            case grpc.StatusCode.UNIMPLEMENTED:
                cause = "agent_protocol"
                message = f"{subject} does not offer {where.split()[0]}: {details}"
            case _:
                # Printed text arrives later than the answer, so the answer has the traceback too.
                message, _, traceback = details.partition("\n")
                log = self._host.tail()
                return AgentError(
                    f"{subject} failed in {where}: {message or code.name}",
                    log=log if traceback.strip() in log else f"{log}\n{traceback}",
                )
        self._host.end()
        return AgentError(message, cause=cause, log=self._host.tail())


def _columns(names: Sequence[str]) -> dict[str, int]:
    """Returns the columns of the log by name.

    Raises:
        AgentError: A name is repeated, is too long, or there are too many.
    """
    columns = {name: column for column, name in enumerate(names)}
    if len(columns) < len(names):
        found = next(name for column, name in enumerate(names) if columns[name] != column)
        raise invalid(f"the ADS declares {found[:_LONGEST_NAME]!r} for its log twice")
    longest = max(map(len, names), default=0)
    if len(names) > _MOST_NAMES or longest > _LONGEST_NAME:
        raise invalid(
            f"the ADS declares {len(names)} values for its log, with names of up to {longest} "
            f"characters; allowed: {_MOST_NAMES} values, {_LONGEST_NAME} characters"
        )
    return columns
