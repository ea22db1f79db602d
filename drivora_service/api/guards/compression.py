"""Compression of answers: zstd or gzip, as the client accepts."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from typing import Literal

from fastapi import Request, Response

from drivora_service.api.guards.entity_tags import cache_headers, is_known
from drivora_service.api.guards.negotiation import Coding, accepted_coding

_GZIP_LEVEL = 1
"""The fastest: higher ones take several times as long for a few per cent of numbers."""
_GZIP_WINDOW = 31
"""Of zlib: the largest window, in the format of gzip."""


def compress_stream(parts: Iterator[bytes], coding: Literal["gzip", "zstd"]) -> Iterator[bytes]:
    """Compresses a stream; what comes of each part can be read before the next part comes."""
    return _gzip(parts) if coding == "gzip" else _zstd(parts)


def compressed_answer(
    request: Request, content: Callable[[], bytes], *, media_type: str, etag: str
) -> Response:
    """Answers with bytes that compress well, or with 304 if the client has them already.

    Args:
        request: The request.
        content: Makes the bytes; called only if they are sent.
        media_type: Of the bytes.
        etag: Stands for them.
    """
    coding, headers = negotiate_coding(request, etag)
    if is_known(request, headers["ETag"].strip('"')):
        return Response(status_code=304, headers=headers)
    body = content()
    if coding:
        headers["Content-Encoding"] = coding
        body = b"".join(compress_stream(iter([body]), coding))
    return Response(body, media_type=media_type, headers=headers)


def negotiate_coding(request: Request, etag: str) -> tuple[Coding, dict[str, str]]:
    """Returns the coding of an answer that may be compressed, and the headers for its caching.

    Two codings of the same content are different bytes, with an ``ETag`` each.
    """
    coding = accepted_coding(request.headers.get("accept-encoding", ""))
    headers = cache_headers(f"{etag}{coding and '-'}{coding}")
    headers["Vary"] += ", Accept-Encoding"
    return coding, headers


def _gzip(parts: Iterator[bytes]) -> Iterator[bytes]:
    compressor = zlib.compressobj(_GZIP_LEVEL, zlib.DEFLATED, _GZIP_WINDOW)
    for part in parts:
        yield compressor.compress(part) + compressor.flush(zlib.Z_SYNC_FLUSH)
    yield compressor.flush()


def _zstd(parts: Iterator[bytes]) -> Iterator[bytes]:
    import pyarrow as pa

    from drivora_service.observations.trace_files.table_stream import PartsFile

    sink = PartsFile()
    with pa.CompressedOutputStream(pa.PythonFile(sink, mode="w"), "zstd") as compressor:
        for part in parts:
            compressor.write(part)
            compressor.flush()
            yield sink.take()
    yield sink.take()
