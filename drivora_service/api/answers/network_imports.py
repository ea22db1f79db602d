"""Uploads of road networks: received into a file, and imported by a process with limits.

The service itself reads no network before that process has accepted it.
"""

from __future__ import annotations

import asyncio
import shutil
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import BinaryIO, ParamSpec

from starlette.requests import ClientDisconnect, Request

from drivora_service.api.problem_details import ApiError
from drivora_service.errors import StoreUnavailable
from drivora_service.networks.importing.import_order import MADE, SOURCE, ImportLimits, ImportOrder
from drivora_service.networks.importing.source_formats import SourceFormat

P = ParamSpec("P")

RETRY_AFTER_S = 5
"""Seconds after which a client may ask again that was refused for an import of another."""

_WRITE_BYTES = 1 << 20
"""What is gathered before it is written."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Upload:
    """What a client wants to upload.

    Attributes:
        name: Name of the network.
        format: Format of the file.
        replace: Whether it replaces an imported network of the same name.
    """

    name: str
    format: SourceFormat
    replace: bool


class NetworkImports:
    """Imports uploaded networks into a folder, one at a time. For one event loop.

    Attributes:
        count: Imports so far.
    """

    def __init__(self, folder: Path, limits: ImportLimits | None = None) -> None:
        """Creates the imports; nothing is written yet.

        Args:
            folder: Folder of imported networks.
            limits: Limits of the process of an import; ``None``: the usual.
        """
        self.count = 0
        self._folder = folder
        self._limits = limits or ImportLimits()
        self._is_busy = False
        self._stopping = asyncio.Event()

    def remove_left(self) -> None:
        """Removes what is left of uploads to a service that was killed."""
        from drivora_service.networks.importing.staging import remove_left_uploads

        remove_left_uploads(self._folder)

    async def take(self, request: Request, upload: Upload, check_use: Callable[[], None]) -> None:
        """Receives and imports the body of a request; what fails leaves nothing behind.

        Args:
            request: The request; nothing of its body was read.
            upload: What is uploaded.
            check_use: Raises an error if the network must not be replaced now.

        Raises:
            ApiError: Another import is being done, the client left, or the service is stopped.
            NetworkTaken: Another network has the name.
            NetworkError: The file cannot be used.
            StoreUnavailable: Nothing can be written at the moment.
        """
        await asyncio.to_thread(self._check, upload, check_use)
        with self._turn():
            await self._until_stopped(self._import(request, upload, check_use))

    def stop(self) -> None:
        """Ends the import that is being done, and all that follow."""
        self._stopping.set()

    async def _until_stopped(self, work: Coroutine[None, None, None]) -> None:
        doing = asyncio.create_task(work)
        stopping = asyncio.create_task(self._stopping.wait())
        try:
            await asyncio.wait((doing, stopping), return_when=asyncio.FIRST_COMPLETED)
            if not doing.done():
                raise ApiError(
                    HTTPStatus.SERVICE_UNAVAILABLE,
                    "the service is being stopped; import the network again later",
                    headers={"Retry-After": str(RETRY_AFTER_S)},
                )
            doing.result()
        finally:
            stopping.cancel()
            doing.cancel()
            # Nothing of it is left when this ends.
            await asyncio.gather(doing, return_exceptions=True)

    async def _import(
        self, request: Request, upload: Upload, check_use: Callable[[], None]
    ) -> None:
        with _convert_storage_errors(), self._stage() as stage:
            try:
                await _receive(request, stage / SOURCE)
                await self._make(request, upload, stage)
            except ClientDisconnect:
                # No client gets this answer.
                raise ApiError(HTTPStatus.BAD_REQUEST, "the client left; nothing is kept") from None
            # Both may have changed meanwhile.
            await _in_thread(self._publish, upload, stage, check_use)

    def _check(self, upload: Upload, check_use: Callable[[], None]) -> None:
        """Refuses what can be refused before the body is read."""
        from drivora_service.networks.importing.netconvert import netconvert_version
        from drivora_service.networks.importing.network_importing import check_name
        from drivora_service.networks.importing.source_formats import FORMATS

        check_name(upload.name, self._folder, replace=upload.replace)
        if FORMATS[upload.format].reader is not None:
            netconvert_version()
        if upload.replace:
            check_use()

    @contextmanager
    def _turn(self) -> Iterator[None]:
        if self._is_busy:
            raise ApiError(
                HTTPStatus.TOO_MANY_REQUESTS,
                "another network is being imported, and one is imported at a time; try again in "
                f"{RETRY_AFTER_S} s",
                headers={"Retry-After": str(RETRY_AFTER_S)},
            )
        self._is_busy = True
        try:
            yield
        finally:
            self._is_busy = False

    @contextmanager
    def _stage(self) -> Iterator[Path]:
        from drivora_service.networks.importing.staging import UPLOADING, make_stage

        stage = make_stage(self._folder, UPLOADING)
        try:
            yield stage
        finally:
            shutil.rmtree(stage, ignore_errors=True)

    async def _make(self, request: Request, upload: Upload, stage: Path) -> None:
        """Imports the uploaded network into ``stage``, unless the client leaves meanwhile."""
        from drivora_service.networks.importing.confined_import import import_confined

        order = ImportOrder(format=upload.format, name=upload.name, limits=self._limits)
        cancelled = threading.Event()
        making = asyncio.create_task(asyncio.to_thread(import_confined, order, stage, cancelled))
        leaving = asyncio.create_task(_until_left(request))
        try:
            await asyncio.wait((making, leaving), return_when=asyncio.FIRST_COMPLETED)
            if not making.done():
                raise ClientDisconnect
            making.result()
        finally:
            leaving.cancel()
            cancelled.set()
            # The process must have ended before its folder is removed.
            await asyncio.gather(making, return_exceptions=True)

    def _publish(self, upload: Upload, stage: Path, check_use: Callable[[], None]) -> None:
        from drivora_service.networks.importing.staging import publish

        self._check(upload, check_use)
        publish(stage / MADE, self._folder / upload.name, replace=upload.replace)
        self.count += 1


async def _receive(request: Request, path: Path) -> None:
    """Writes the body of a request to a file as it comes."""
    with path.open("wb") as file:
        gathered = bytearray()
        async for part in request.stream():
            gathered += part
            if len(gathered) >= _WRITE_BYTES:
                await _in_thread(_write, file, bytes(gathered))
                gathered.clear()
        await _in_thread(_write, file, bytes(gathered))


async def _in_thread(function: Callable[P, None], *args: P.args, **kwargs: P.kwargs) -> None:
    """Calls a function in a thread, and waits for its end even if it is not wanted any more.

    Else its folder would be removed while it writes there.
    """
    calling = asyncio.create_task(asyncio.to_thread(function, *args, **kwargs))
    try:
        await asyncio.shield(calling)
    finally:
        await asyncio.gather(calling, return_exceptions=True)


def _write(file: BinaryIO, data: bytes) -> None:
    file.write(data)
    file.flush()


async def _until_left(request: Request) -> None:
    """Waits until the client of a request leaves, whose body has been read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


@contextmanager
def _convert_storage_errors() -> Iterator[None]:
    """Turns errors of the file system into one that tells the client to try again."""
    try:
        yield
    except OSError as error:
        raise StoreUnavailable(
            f"the network cannot be stored now: {error.strerror}; nothing is kept"
        ) from error
