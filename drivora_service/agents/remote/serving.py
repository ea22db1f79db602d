"""Serving an ADS: the loop that an adapter calls in the ADS's own process and environment.

All imports of this module need grpcio, protobuf and NumPy only.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NoReturn

import grpc

from drivora_service.agents.log import AgentLog
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.adapter_messages import (
    context_view,
    observation_view,
    raster_request,
    step_reply,
)
from drivora_service.agents.remote.agent_pb2_grpc import (
    AgentServicer,
    add_AgentServicer_to_server,
)
from drivora_service.agents.remote.protocol import ADDRESS_VARIABLE, MESSAGE_BYTES, VERSION
from drivora_service.agents.remote.requested_rasters import RequestedRasters
from drivora_service.agents.remote.views import Adapter

_DETAILS = 3000
"""Characters of an error's traceback that are sent with its message."""


def serve(make_adapter: Callable[[], Adapter], *, name: str = "", address: str = "") -> None:
    """Serves an ADS until the process is ended.

    Args:
        make_adapter: Factory of the adapter, called once before the server accepts calls; load
            models here. Errors that it raises end the process.
        name: Display name.
        address: Address, ``unix:PATH`` or ``HOST:PORT``; by default that of Drivora's variable.

    Raises:
        RuntimeError: There is no address, or it cannot be bound.
    """
    where = address or os.environ.get(ADDRESS_VARIABLE, "")
    if not where:
        raise RuntimeError(
            f"no address to listen on: set {ADDRESS_VARIABLE} to unix:PATH or HOST:PORT"
        )
    service = _Service(make_adapter(), name)
    # One thread: calls never overlap, so an ADS need not be thread-safe.
    server = grpc.server(
        ThreadPoolExecutor(max_workers=1),
        options=[
            ("grpc.max_receive_message_length", MESSAGE_BYTES),
            ("grpc.max_send_message_length", MESSAGE_BYTES),
            # Otherwise a second process could listen on the same port and receive some calls.
            ("grpc.so_reuseport", 0),
        ],
    )
    add_AgentServicer_to_server(service, server)  # type: ignore[no-untyped-call] # generated
    if not server.add_insecure_port(where):
        raise RuntimeError(f"cannot listen on {where}")
    server.start()
    server.wait_for_termination()


class _Service(AgentServicer):
    def __init__(self, adapter: Adapter, name: str) -> None:
        self._adapter, self._name = adapter, name
        self._log = AgentLog()
        self._rasters = RequestedRasters()
        self._run = ""

    def Describe(
        self, request: pb.DescribeRequest, context: grpc.ServicerContext
    ) -> pb.Description:
        return pb.Description(protocol=VERSION, name=self._name)

    def SetupEnv(self, request: pb.SetupRequest, context: grpc.ServicerContext) -> pb.SetupReply:
        if request.protocol != VERSION:
            context.abort(
                grpc.StatusCode.FAILED_PRECONDITION,
                f"the adapter speaks version {VERSION} of the protocol, Drivora {request.protocol}",
            )
        self._run, self._log = request.run, AgentLog()
        self._rasters = rasters = RequestedRasters(request.raster_channels)
        try:
            self._adapter.setup_env(context_view(request, self._log, rasters))
        except Exception as error:
            _abort(context, error)
        return pb.SetupReply(
            log_names=self._log.names,
            text=self._texts(),
            rasters=[raster_request(settings) for settings in rasters.close()],
        )

    def RunStep(self, request: pb.StepRequest, context: grpc.ServicerContext) -> pb.StepReply:
        if request.run != self._run:
            context.abort(
                grpc.StatusCode.FAILED_PRECONDITION,
                "another run has begun here since: an ADS drives one ego at a time. Use one worker "
                "and one ego with it, or let Drivora start it",
            )
        log = self._log
        log.step = request.step
        log.events.clear()
        log.plans.clear()
        log.row.fill(float("nan"))
        self._rasters.receive(request.step, request.rasters)
        try:
            return step_reply(self._adapter.run_step(observation_view(request)), log)
        except Exception as error:
            _abort(context, error)

    def _texts(self) -> str:
        return "\n".join(message for _, message in self._log.events)


def _abort(context: grpc.ServicerContext, error: Exception) -> NoReturn:
    text = "".join(traceback.format_exception(error))
    print(text, file=sys.stderr, flush=True)
    message = " ".join(f"{type(error).__name__}: {error}".split())
    details = f"{message[:_DETAILS]}\n{text[-_DETAILS:]}"
    # Names of files may contain invalid Unicode.
    context.abort(grpc.StatusCode.UNKNOWN, details.encode(errors="backslashreplace").decode())
