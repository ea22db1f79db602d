"""The three calls of the protocol, from Drivora's side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import grpc
from google.protobuf.message import DecodeError, Message

from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.messages import invalid
from drivora_service.agents.remote.protocol import DESCRIBE, MESSAGE_BYTES, RUN_STEP, SETUP_ENV

M = TypeVar("M", bound=Message)

_OPTIONS = [
    ("grpc.max_receive_message_length", MESSAGE_BYTES),
    ("grpc.max_send_message_length", MESSAGE_BYTES),
    # An ADS that starts is looked for often; the default waits a second after the first refusal.
    ("grpc.initial_reconnect_backoff_ms", 50),
    ("grpc.min_reconnect_backoff_ms", 50),
    ("grpc.max_reconnect_backoff_ms", 500),
    ("grpc.enable_http_proxy", 0),
    # What an ADS says of an error travels as a header, in which a character may take twelve bytes.
    ("grpc.max_metadata_size", 128 << 10),
    ("grpc.absolute_max_metadata_size", 256 << 10),
    # Channels to one address would else share a connection, and what is known of its failures.
    ("grpc.use_local_subchannel_pool", 1),
]


class Connection:
    """A channel to an ADS. Answers are parsed here, so that a garbled one can be told apart."""

    def __init__(self, address: str) -> None:
        self._channel = grpc.insecure_channel(address, options=_OPTIONS)
        self._describe = self._call(DESCRIBE)
        self._setup = self._call(SETUP_ENV)
        self._step = self._call(RUN_STEP)

    def _call(self, name: str) -> Callable[..., Any]:
        return self._channel.unary_unary(name)

    def describe(self, timeout: float) -> pb.Description:
        """Asks who answers.

        Raises:
            grpc.RpcError: The call failed.
            AgentError: The answer is garbled.
        """
        request = pb.DescribeRequest().SerializeToString()
        return _parse(pb.Description, self._describe(request, timeout=timeout, wait_for_ready=True))

    def setup(self, request: pb.SetupRequest, timeout: float) -> pb.SetupReply:
        """Begins a run; raises as :meth:`describe` does."""
        return _parse(pb.SetupReply, self._setup(request.SerializeToString(), timeout=timeout))

    def step(self, request: pb.StepRequest, timeout: float) -> pb.StepReply:
        """Asks for a control; raises as :meth:`describe` does."""
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
