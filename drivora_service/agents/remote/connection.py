"""The three calls of the protocol, from Drivora's side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import grpc
from google.protobuf.message import DecodeError, Message

from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.protocol import DESCRIBE, MESSAGE_BYTES, RUN_STEP, SETUP_ENV
from drivora_service.agents.remote.remote_messages import invalid

M = TypeVar("M", bound=Message)

_OPTIONS = [
    ("grpc.max_receive_message_length", MESSAGE_BYTES),
    ("grpc.max_send_message_length", MESSAGE_BYTES),
    # A starting ADS is polled often; by default a second passes after the first refusal.
    ("grpc.initial_reconnect_backoff_ms", 50),
    ("grpc.min_reconnect_backoff_ms", 50),
    ("grpc.max_reconnect_backoff_ms", 500),
    ("grpc.enable_http_proxy", 0),
    # The text of an error is sent as a header, in which a character may take twelve bytes.
    ("grpc.max_metadata_size", 128 << 10),
    ("grpc.absolute_max_metadata_size", 256 << 10),
    # Otherwise channels to one address would share a connection and its failures.
    ("grpc.use_local_subchannel_pool", 1),
]


class Connection:
    """A channel to an ADS. Answers are parsed here, so that a garbled one is recognised."""

    def __init__(self, address: str) -> None:
        self._channel = grpc.insecure_channel(address, options=_OPTIONS)
        self._describe = self._call(DESCRIBE)
        self._setup = self._call(SETUP_ENV)
        self._step = self._call(RUN_STEP)

    def _call(self, name: str) -> Callable[..., Any]:
        return self._channel.unary_unary(name)

    def describe(self, timeout: float) -> pb.Description:
        """Calls ``Describe``.

        Raises:
            grpc.RpcError: The call failed.
            AgentError: The answer is garbled.
        """
        request = pb.DescribeRequest().SerializeToString()
        return _parse(pb.Description, self._describe(request, timeout=timeout, wait_for_ready=True))

    def setup(self, request: pb.SetupRequest, timeout: float) -> pb.SetupReply:
        """Returns the answer to the beginning of a run; raises as :meth:`describe`."""
        return _parse(pb.SetupReply, self._setup(request.SerializeToString(), timeout=timeout))

    def step(self, request: pb.StepRequest, timeout: float) -> pb.StepReply:
        """Returns the answer to an observation, a control; raises as :meth:`describe`."""
        return _parse(pb.StepReply, self._step(request.SerializeToString(), timeout=timeout))

    def close(self) -> None:
        """Ends the channel and the calls on it."""
        self._channel.close()


def _parse(type_: type[M], data: bytes) -> M:
    try:
        return type_.FromString(data)
    except DecodeError as error:
        raise invalid(
            f"the ADS answered {len(data)} bytes that are no {type_.DESCRIPTOR.name} of the "
            "protocol"
        ) from error
