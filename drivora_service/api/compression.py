"""Compression of streamed answers: zstd or gzip, as the client accepts."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from typing import Literal

Coding = Literal["", "gzip", "zstd"]
"""Of the content of an answer; "": as it is."""

_GZIP_LEVEL = 1
"""The fastest: higher ones take several times as long for a few per cent of numbers."""
_GZIP_WINDOW = 31
"""Of zlib: the largest window, in the format of gzip."""


def accepted_coding(accept_encoding: str) -> Coding:
    """Returns the best coding that a client accepts, by its header; zstd before gzip."""
    accepted: dict[str, float] = {}
    for part in accept_encoding.lower().split(","):
        name, _, parameter = part.partition(";")
        accepted[name.strip()] = _weight(parameter)
    usual = accepted.get("*", 0.0)
    if accepted.get("zstd", usual) > 0.0:
        return "zstd"
    return "gzip" if accepted.get("gzip", usual) > 0.0 else ""


def compressed(parts: Iterator[bytes], coding: Literal["gzip", "zstd"]) -> Iterator[bytes]:
    """Compresses a stream; what comes of each part can be read before the next part comes."""
    return _gzip(parts) if coding == "gzip" else _zstd(parts)


def _weight(parameter: str) -> float:
    name, _, value = parameter.strip().partition("=")
    if name.strip() != "q":
        return 1.0
    try:
        return float(value)
    except ValueError:
        return 0.0


def _gzip(parts: Iterator[bytes]) -> Iterator[bytes]:
    compressor = zlib.compressobj(_GZIP_LEVEL, zlib.DEFLATED, _GZIP_WINDOW)
    for part in parts:
        yield compressor.compress(part) + compressor.flush(zlib.Z_SYNC_FLUSH)
    yield compressor.flush()


def _zstd(parts: Iterator[bytes]) -> Iterator[bytes]:
    import pyarrow as pa

    from drivora_service.observations.table_stream import PartsFile

    sink = PartsFile()
    with pa.CompressedOutputStream(pa.PythonFile(sink, mode="w"), "zstd") as compressor:
        for part in parts:
            compressor.write(part)
            compressor.flush()
            yield sink.take()
    yield sink.take()
