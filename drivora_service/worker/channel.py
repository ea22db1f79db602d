"""Messages between a slot and the processes that it owns: frames of bytes, never pickles.

A worker runs code under test, which may write anything to its end of the channel, or stop in the
middle of a message. So the slot's end never blocks, holds no more than one message of bounded
length, and drops a message that does not end in time.
"""

from __future__ import annotations

import contextlib
import select
import socket
import struct
import time
from dataclasses import dataclass
from enum import IntEnum

LONGEST_BODY = 16 << 20
"""Largest message that a slot accepts, in bytes; parsed, it takes some twenty times that."""

_MAGIC = b"drvr"
_HEADER = struct.Struct("!4sII")
_CHUNK = 1 << 16
"""Bytes that are sent or received at once; memory for more would be mapped anew each time."""
_WHOLE_WITHIN_S = 10.0
"""Seconds within which a message must be complete after its first byte."""


class Kind(IntEnum):
    """The kind of a message."""

    READY = 1
    NOT_READY = 2
    RUN = 3
    REPORT = 4
    STARTED = 5
    ENDED = 6
    END = 7
    LOOK = 8
    LEFTOVERS = 9


class ProtocolError(Exception):
    """The other side sent bytes that are no message of this protocol."""


class ChannelClosedError(Exception):
    """The other side has closed its end."""


@dataclass(frozen=True, slots=True)
class Frame:
    """One message."""

    kind: Kind
    body: bytes = b""


class Channel:
    """A slot's end of a channel."""

    def __init__(self, end: socket.socket) -> None:
        """Takes ownership of one end of a pair of stream sockets."""
        end.setblocking(False)
        self._socket = end
        self._coming = bytearray()
        self._going = bytearray()
        self._begun = 0.0

    def fileno(self) -> int:
        """Returns the file descriptor, -1 once it is closed."""
        return self._socket.fileno()

    @property
    def has_more_to_send(self) -> bool:
        """Whether a part of a message is still to be sent."""
        return bool(self._going)

    @property
    def is_within_message(self) -> bool:
        """Whether a message has been received in part."""
        return bool(self._coming)

    @property
    def has_message(self) -> bool:
        """Whether a whole message has been received and not read."""
        return len(self._coming) >= _HEADER.size and (
            len(self._coming) >= _HEADER.size + _HEADER.unpack_from(self._coming)[2]
        )

    def put(self, frame: Frame) -> None:
        """Sends as much of a message as fits without blocking; :meth:`flush` sends the rest."""
        self._going += _bytes_of(frame)
        self.flush()

    def flush(self) -> None:
        """Sends as much of the pending bytes as fits without blocking."""
        if not self._going:
            return
        # The next read finds a closed end.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError, BlockingIOError):
            while self._going:
                del self._going[: self._socket.send(bytes(self._going[:_CHUNK]))]

    def read(self) -> Frame | None:
        """Returns the next whole message, ``None`` if there is none.

        Raises:
            ProtocolError: The bytes are no message, or a message is not complete in time.
            ChannelClosedError: The other side has closed its end; no message is left.
        """
        while (frame := self._next()) is None:
            try:
                data = self._socket.recv(_CHUNK)
            except BlockingIOError:
                if self._coming and time.monotonic() - self._begun > _WHOLE_WITHIN_S:
                    raise ProtocolError(
                        f"a message that was begun did not end within {_WHOLE_WITHIN_S:g} s"
                    ) from None
                return None
            except ConnectionResetError:
                data = b""
            if not data:
                raise ChannelClosedError("closed by the other side")
            if not self._coming:
                self._begun = time.monotonic()
            self._coming += data
        return frame

    def _next(self) -> Frame | None:
        """Takes a whole message out of the received bytes."""
        if len(self._coming) < _HEADER.size:
            return None
        kind, length = _parse_header(self._coming)
        if length > LONGEST_BODY:
            raise ProtocolError(f"a message of {length} bytes; allowed: {LONGEST_BODY}")
        end = _HEADER.size + length
        if len(self._coming) < end:
            return None
        frame = Frame(kind, bytes(self._coming[_HEADER.size : end]))
        del self._coming[:end]
        self._begun = time.monotonic()
        return frame

    def close(self) -> None:
        """Closes this end."""
        self._socket.close()


class Waiting:
    """Waits for several channels; asks the system once a wait."""

    def __init__(self, *channels: Channel) -> None:
        """Registers channels, which must be open."""
        self._channels = channels
        self._poll = select.poll()
        self._sending = dict.fromkeys(channels, False)
        for channel in channels:
            self._poll.register(channel, select.POLLIN)

    def wait(self, timeout: float) -> bool:
        """Waits until a channel has bytes to read or room to send; sends pending bytes.

        Args:
            timeout: Seconds after which it returns in any case.

        Returns:
            Whether there is something to read or to send.
        """
        for channel in self._channels:
            sending = channel.has_more_to_send
            if sending != self._sending[channel]:
                self._sending[channel] = sending
                self._poll.modify(channel, select.POLLIN | (select.POLLOUT if sending else 0))
        events = self._poll.poll(1000.0 * timeout)
        for channel in self._channels:
            channel.flush()
        return bool(events)


def send(end: socket.socket, *frames: Frame) -> None:
    """Sends messages from the process that a slot owns; blocks until they are sent."""
    end.sendall(b"".join(map(_bytes_of, frames)))


def receive(end: socket.socket) -> Frame:
    """Waits for a message in the process that a slot owns.

    Raises:
        ChannelClosedError: The slot has closed its end.
        ProtocolError: The bytes are no message.
    """
    kind, length = _parse_header(_exactly(end, _HEADER.size))
    return Frame(kind, bytes(_exactly(end, length)))


def _bytes_of(frame: Frame) -> bytes:
    return _HEADER.pack(_MAGIC, frame.kind, len(frame.body)) + frame.body


def _exactly(end: socket.socket, count: int) -> bytearray:
    found = bytearray()
    while len(found) < count:
        data = end.recv(min(count - len(found), _CHUNK))
        if not data:
            raise ChannelClosedError("closed by the slot")
        found += data
    return found


def _parse_header(data: bytearray) -> tuple[Kind, int]:
    magic, kind, length = _HEADER.unpack_from(data)
    if magic != _MAGIC:
        raise ProtocolError(f"found {bytes(magic)!r} where a message begins; expected {_MAGIC!r}")
    try:
        return Kind(kind), length
    except ValueError:
        raise ProtocolError(f"a message of the unknown kind {kind}") from None
