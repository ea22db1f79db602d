"""The synchronous client."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self, TypeVar

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
from drivora_service.client.operations import BlockingOperations
from drivora_service.client.replies import Reply
from drivora_service.client.streams import Stream
from drivora_service.client.transport import ApplicationTransport
from drivora_service.errors import ServiceError

if TYPE_CHECKING:
    from drivora_service.api.schemas.batches import Batch
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.api.schemas.runs import Run
    from drivora_service.api.schemas.studies import Study

T = TypeVar("T")


class Client(BlockingOperations):
    """Asks one service, or the application in this process; a context manager.

    Several threads may use one client. Its methods raise ``InvalidDocument`` where the service
    refuses a document and ``ServiceError`` where it refuses for another reason or does not answer.
    Requests that may be repeated are tried again after faults that pass; see :mod:`flows`.
    """

    def __init__(
        self,
        url: str = "",
        *,
        token: str | None = None,
        transport: httpx.BaseTransport | None = None,
        retry_s: float = RETRY_S,
        timeout_s: float = TIMEOUT_S,
        on_retry: OnRetry = ignore_retry,
    ) -> None:
        """Creates a client; no request is sent yet.

        Args:
            url: Address of the service, such as ``http://127.0.0.1:8000``.
            token: API token; ``None``: the environment's ``DRIVORA_TOKEN``, if any.
            transport: How requests travel; an :class:`ApplicationTransport` needs no address.
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
            is_local=isinstance(transport, ApplicationTransport),
            retry_s=retry_s,
            timeout_s=timeout_s,
            on_retry=on_retry,
        )
        self._terms = made.terms
        self._http = httpx.Client(
            base_url=made.url, headers=made.headers, timeout=made.timeout, transport=transport
        )

    def __enter__(self) -> Self:
        """Returns the client itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the client."""
        self.close()

    def close(self) -> None:
        """Closes the connections; an application in this process is shut down."""
        self._http.close()

    def ask(self, call: Call[T]) -> T:
        """Sends the request of a call and returns its answer."""
        return self._result(perform_call(call, self._terms)).value

    def items(self, listing: Listing[T]) -> Iterator[T]:
        """Returns the items of a list; a page is asked for when its first item is wanted."""
        return self._emit_items(list_items(listing, self._terms))

    def listen(self, call: Call[bytes]) -> Iterator[Event]:
        """Returns the events of a call as they come; it is made when the first is wanted."""
        return self._emit_items(receive_events(call, self._terms))

    def save(self, call: Call[bytes], path: Path) -> None:
        """Writes the answer of a call to a file as it comes; the file is whole or absent.

        Raises:
            StoreError: The file cannot be written.
        """
        self._result(perform_call(call, self._terms, target=path))

    def expect_workers(self) -> None:
        """Checks that the service can begin runs.

        Raises:
            ServiceError: It cannot, or did not answer.
        """
        self._result(check_workers(self._terms))

    def wait_for_batch(
        self, batch_id: str, *, on_progress: Callable[[Batch], None] = ignore_progress
    ) -> Iterator[Run]:
        """Returns the runs of a batch as they end, each once, in any order.

        Args:
            batch_id: Which batch.
            on_progress: Called with the batch at every look.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return self._emit_items(watch_batch(batch_id, self._terms, on_progress))

    def follow_campaign(
        self, campaign_id: str, *, on_progress: Callable[[Campaign], None] = ignore_progress
    ) -> Campaign:
        """Waits until a campaign has ended or is paused, and returns it.

        Args:
            campaign_id: Which campaign.
            on_progress: Called with the campaign at every look, the last one included.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return self._result(watch_campaign(campaign_id, self._terms, on_progress))

    def follow_study(
        self, study_id: str, *, on_progress: Callable[[Study], None] = ignore_progress
    ) -> Study:
        """Waits until no campaign of a study runs or waits, and returns the study.

        Args:
            study_id: Which study.
            on_progress: Called with the study at every look, the last one included.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        return self._result(watch_study(study_id, self._terms, on_progress))

    def wait_for_minimization(
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
        return self._result(watch_minimization(minimization_id, self._terms, on_progress))

    def _result(self, flow: Flow[T]) -> T:
        outcome: Outcome = None
        with Stream(self._http) as stream:
            while True:
                try:
                    step = flow.send(outcome)
                except StopIteration as end:
                    result: T = end.value
                    return result
                outcome = self._perform_step(step, stream)

    def _emit_items(self, flow: Items[T]) -> Iterator[T]:
        outcome: Outcome = None
        with contextlib.closing(flow), Stream(self._http) as stream:
            while True:
                try:
                    step = flow.send(outcome)
                except StopIteration:
                    return
                if isinstance(step, Emit):
                    yield step.value
                    outcome = None
                else:
                    outcome = self._perform_step(step, stream)

    def _perform_step(self, step: Step, stream: Stream) -> Outcome:
        match step:
            case Sleep():
                time.sleep(step.seconds)
                return None
            case Request():
                try:
                    return self._reply(step)
                except httpx.RequestError as error:
                    return error
            case Listen() | Receive():
                if self._http.is_closed:
                    raise ServiceError(CLOSED)
                try:
                    if isinstance(step, Listen):
                        return stream.listen(step)
                    return stream.receive()
                except httpx.RequestError as error:
                    return error

    def _reply(self, request: Request) -> Reply:
        if self._http.is_closed:
            raise ServiceError(CLOSED)
        call = request.call
        with (
            open_body(call) as body,
            self._http.stream(
                call.method,
                call.path,
                params=call.parameters,
                content=body,
                headers=request.headers,
                timeout=timeout_of(call, self._http.timeout),
            ) as response,
        ):
            content = b""
            if request.target is None or not response.is_success:
                content = response.read()
            else:
                with open_replacement(request.target) as file:
                    for part in response.iter_bytes():
                        file.write(part)
            return Reply(status=response.status_code, headers=response.headers, content=content)
