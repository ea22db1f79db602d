"""The asynchronous client."""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, BinaryIO, Self, TypeVar

import anyio
import httpx

from drivora_service.client.call import Call, Listing
from drivora_service.client.connecting import (
    CLOSED,
    RETRY_S,
    TIMEOUT_S,
    OnRetry,
    connection,
    ignore_progress,
    ignore_retry,
    open_body,
    open_replacement,
    timeout_of,
)
from drivora_service.client.flows import (
    Emit,
    Flow,
    Items,
    Listen,
    Outcome,
    Receive,
    Request,
    Sleep,
    Step,
    list_items,
    perform_call,
)
from drivora_service.client.following import (
    check_workers,
    watch_batch,
    watch_campaign,
    watch_minimization,
    watch_study,
)
from drivora_service.client.listening import Event, receive_events
from drivora_service.client.operations import AwaitedOperations
from drivora_service.client.replies import Reply
from drivora_service.client.streams import AsyncStream
from drivora_service.client.transport import AsyncApplicationTransport
from drivora_service.errors import ServiceError

if TYPE_CHECKING:
    from drivora_service.api.schemas.batches import Batch
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.api.schemas.runs import Run
    from drivora_service.api.schemas.studies import Study

T = TypeVar("T")

_PART_BYTES = 1 << 16


class AsyncClient(AwaitedOperations):
    """Asks one service, or the application in this process; an asynchronous context manager.

    As :class:`Client`, for asyncio.
    """

    def __init__(
        self,
        url: str = "",
        *,
        token: str | None = None,
        transport: httpx.AsyncBaseTransport | None = None,
        retry_s: float = RETRY_S,
        timeout_s: float = TIMEOUT_S,
        on_retry: OnRetry = ignore_retry,
    ) -> None:
        """Creates a client; no request is sent yet.

        Args:
            url: Address of the service, such as ``http://127.0.0.1:8000``.
            token: API token; ``None``: the environment's ``DRIVORA_TOKEN``, if any.
            transport: How requests travel; an :class:`AsyncApplicationTransport` needs no address.
            retry_s: Seconds for which a request that may be repeated is tried again; 0: never.
            timeout_s: Seconds for which a service may be silent; one in this process as long as it
                needs.
            on_retry: Called with the reason of a retry and the seconds before it.

        Raises:
            ConfigurationError: The address or the token cannot be used.
        """
        made = connection(
            url,
            token,
            is_local=isinstance(transport, AsyncApplicationTransport),
            retry_s=retry_s,
            timeout_s=timeout_s,
            on_retry=on_retry,
        )
        self._terms = made.terms
        self._http = httpx.AsyncClient(
            base_url=made.url, headers=made.headers, timeout=made.timeout, transport=transport
        )

    async def __aenter__(self) -> Self:
        """Returns the client itself."""
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the client."""
        await self.aclose()

    async def aclose(self) -> None:
        """Closes the connections; an application in this process is shut down."""
        await self._http.aclose()

    async def ask(self, call: Call[T]) -> T:
        """Sends the request of a call and returns its answer."""
        return (await self._result(perform_call(call, self._terms))).value

    def items(self, listing: Listing[T]) -> AsyncIterator[T]:
        """Returns the items of a list; a page is asked for when its first item is wanted."""
        return self._emit_items(list_items(listing, self._terms))

    def listen(self, call: Call[bytes]) -> AsyncIterator[Event]:
        """Returns the events of a call as they come; it is made when the first is wanted."""
        return self._emit_items(receive_events(call, self._terms))

    async def save(self, call: Call[bytes], path: Path) -> None:
        """Writes the answer of a call to a file as it comes; the file is whole or absent.

        Raises:
            StoreError: The file cannot be written.
        """
        await self._result(perform_call(call, self._terms, target=path))

    async def expect_workers(self) -> None:
        """Checks that the service can begin runs.

        Raises:
            ServiceError: It cannot, or did not answer.
        """
        await self._result(check_workers(self._terms))

    def wait_for_batch(
        self, batch_id: str, *, on_progress: Callable[[Batch], None] = ignore_progress
    ) -> AsyncIterator[Run]:
        """Returns the runs of a batch as they end, each once, in any order.

        Args:
            batch_id: Which batch.
            on_progress: Called with the batch at every look.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return self._emit_items(watch_batch(batch_id, self._terms, on_progress))

    async def follow_campaign(
        self, campaign_id: str, *, on_progress: Callable[[Campaign], None] = ignore_progress
    ) -> Campaign:
        """Waits until a campaign has ended or is paused, and returns it.

        Args:
            campaign_id: Which campaign.
            on_progress: Called with the campaign at every look, the last one included.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return await self._result(watch_campaign(campaign_id, self._terms, on_progress))

    async def follow_study(
        self, study_id: str, *, on_progress: Callable[[Study], None] = ignore_progress
    ) -> Study:
        """Waits until no campaign of a study runs or waits, and returns the study.

        Args:
            study_id: Which study.
            on_progress: Called with the study at every look, the last one included.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return await self._result(watch_study(study_id, self._terms, on_progress))

    async def wait_for_minimization(
        self,
        minimization_id: str,
        *,
        on_progress: Callable[[Minimization], None] = ignore_progress,
    ) -> Minimization:
        """Waits until a minimisation has ended, and returns it.

        Args:
            minimization_id: Which minimisation.
            on_progress: Called with the minimisation at every look, the last one included.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return await self._result(watch_minimization(minimization_id, self._terms, on_progress))

    async def _result(self, flow: Flow[T]) -> T:
        outcome: Outcome = None
        async with AsyncStream(self._http) as stream:
            while True:
                try:
                    step = flow.send(outcome)
                except StopIteration as end:
                    result: T = end.value
                    return result
                outcome = await self._perform_step(step, stream)

    async def _emit_items(self, flow: Items[T]) -> AsyncIterator[T]:
        outcome: Outcome = None
        with contextlib.closing(flow):
            async with AsyncStream(self._http) as stream:
                while True:
                    try:
                        step = flow.send(outcome)
                    except StopIteration:
                        return
                    if isinstance(step, Emit):
                        yield step.value
                        outcome = None
                    else:
                        outcome = await self._perform_step(step, stream)

    async def _perform_step(self, step: Step, stream: AsyncStream) -> Outcome:
        match step:
            case Sleep():
                await asyncio.sleep(step.seconds)
                return None
            case Request():
                try:
                    return await self._reply(step)
                except httpx.RequestError as error:
                    return error
            case Listen() | Receive():
                if self._http.is_closed:
                    raise ServiceError(CLOSED)
                try:
                    if isinstance(step, Listen):
                        return await stream.listen(step)
                    return await stream.receive()
                except httpx.RequestError as error:
                    return error

    async def _reply(self, request: Request) -> Reply:
        if self._http.is_closed:
            raise ServiceError(CLOSED)
        call = request.call
        with open_body(call) as body:
            sent, headers = (body, {}) if isinstance(body, bytes | None) else _parts(body)
            async with self._http.stream(
                call.method,
                call.path,
                params=call.parameters,
                content=sent,
                headers={**request.headers, **headers},
                timeout=timeout_of(call, self._http.timeout),
            ) as response:
                content = b""
                if request.target is None or not response.is_success:
                    content = await response.aread()
                else:
                    with open_replacement(request.target) as file:
                        async for part in response.aiter_bytes():
                            await anyio.to_thread.run_sync(file.write, part)
                return Reply(status=response.status_code, headers=response.headers, content=content)


def _parts(file: BinaryIO) -> tuple[AsyncIterator[bytes], dict[str, str]]:
    """Returns a file as the body of a request, and the header with its length."""

    async def parts() -> AsyncIterator[bytes]:
        while part := await anyio.to_thread.run_sync(file.read, _PART_BYTES):
            yield part

    return parts(), {"Content-Length": str(os.fstat(file.fileno()).st_size)}
