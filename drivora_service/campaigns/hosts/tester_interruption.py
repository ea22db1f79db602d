"""Interrupting a tester in a thread of a command, if it does not return after a request to stop."""

from __future__ import annotations

import contextlib
import ctypes
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from drivora_service.campaigns.search.tester_calls import CallMemory, TesterCall
from drivora_service.errors import StoreError
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.database import Database

_LOOK_S = 0.25
"""Seconds between two looks at a call."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """How long a request waits for a tester.

    Attributes:
        grace_s: Seconds of a call after which a request interrupts it.
        end_s: Seconds after that until the thread of the campaign is left to itself.
    """

    grace_s: float = 5.0
    end_s: float = 3.0


class TesterInterruption:
    """A second thread that watches the calls of the tester of one campaign.

    Python code of the tester is interrupted as by Ctrl-C, so that what was found is stored. A call
    that sleeps, or works in native code, cannot be interrupted in a thread: it is abandoned, and
    ends with the process. Only native code that holds the interpreter lock stops the command as a
    whole, which then has to be killed.
    """

    __test__ = False

    def __init__(
        self,
        database: Callable[[], Database],
        campaign_id: str,
        requested: Callable[[], CampaignRequest],
        memory: CallMemory,
        patience: Patience = Patience(),  # frozen
    ) -> None:
        """Creates the watch; :meth:`watching` starts it.

        Args:
            database: Returns the database with the campaign.
            campaign_id: Id of the campaign.
            requested: Returns the command's own request to stop; called from the second thread.
            memory: Limit of memory during calls.
            patience: How long a request waits.
        """
        self._database, self._campaign_id = database, campaign_id
        self._own_request, self._memory, self._patience = requested, memory, patience
        self._call = TesterCall.NONE
        self._begun = 0.0
        self._campaign = 0
        self._done = threading.Event()
        self._is_abandoned = False

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        """Watches the tester, which is called in the present thread, meanwhile."""
        self._campaign = threading.get_ident()
        threading.Thread(target=self._watch, name="tester-watch", daemon=True).start()
        try:
            yield
        finally:
            self._done.set()

    def lets_go(self, thread: threading.Thread) -> bool:
        """Returns whether the thread of the campaign has ended, or is not to be waited for."""
        return self._is_abandoned or not thread.is_alive()

    def on_call(self, call: TesterCall) -> None:
        """Takes the begin of a call, or with ``NONE`` the end of one."""
        self._begun = time.monotonic()
        self._call = call
        self._memory.on_call(call)

    def _watch(self) -> None:
        interrupted: tuple[float, float] | None = None
        while not self._done.wait(_LOOK_S):
            now, begun = time.monotonic(), self._begun
            is_long = self._call is not TesterCall.NONE and now - begun > self._patience.grace_s
            request = self._requested() if is_long else CampaignRequest.NONE
            if request is CampaignRequest.NONE:
                continue
            if interrupted is None or interrupted[0] != begun:
                interrupted = begun, now
                _raise_in(self._campaign, KeyboardInterrupt)
            elif now - interrupted[1] > self._patience.end_s:
                self._abandon(request)
                return

    def _requested(self) -> CampaignRequest:
        own = self._own_request()
        if own is not CampaignRequest.NONE:
            return own
        with contextlib.suppress(StoreError), self._database().read() as transaction:
            return transaction.campaigns.request_of(self._campaign_id)
        return CampaignRequest.NONE

    def _abandon(self, request: CampaignRequest) -> None:
        is_cancelled = request is CampaignRequest.CANCEL
        state = CampaignState.CANCELLED if is_cancelled else CampaignState.PAUSED
        try:
            with contextlib.suppress(StoreError), self._database().write() as transaction:
                transaction.campaigns.end(self._campaign_id, state)
        finally:
            self._is_abandoned = True


def _raise_in(thread: int, error: type[BaseException]) -> None:
    """Raises an exception in a thread, at the next instruction of its Python code."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(error))
