"""Where an installation keeps its traces: in its data folder, or in a storage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from drivora_service.store.traces.trace_folders import (
    CampaignTraces,
    FailureTraces,
    RunTraces,
    TraceFolder,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TracePlaces:
    """The places of all traces; can be sent to another process.

    Attributes:
        runs: Folder of those of runs, if there is no storage.
        campaigns: Folder of all campaigns, the same.
        url: Address of the storage, by ``fsspec``; "": there is none.
        copies: Folder of the copies of what is read from the storage.
    """

    runs: Path
    campaigns: Path
    url: str = ""
    copies: Path

    @classmethod
    def below(cls, folder: Path) -> TracePlaces:
        """Returns the places in a data folder."""
        return cls(runs=folder / "traces", campaigns=folder / "campaigns", copies=folder / "copies")

    def of_runs(self) -> RunTraces:
        """Returns the traces of runs.

        Raises:
            ConfigurationError: The storage cannot be used.
        """
        if not self.url:
            return TraceFolder(self.runs)
        from drivora_service.store.traces.remote_traces import RemoteTraceFolder, Storage

        return RemoteTraceFolder(Storage(self.url, self.copies))

    def of_failures(self) -> FailureTraces:
        """Returns the traces of failures of campaigns.

        Raises:
            ConfigurationError: The storage cannot be used.
        """
        if not self.url:
            return CampaignTraces(self.campaigns)
        from drivora_service.store.traces.remote_traces import RemoteCampaignTraces, Storage

        return RemoteCampaignTraces(Storage(self.url, self.copies))

    def storage_probe(self) -> Callable[[], None] | None:
        """Returns what raises an ``OSError`` if nothing can be written to the storage.

        ``None`` if there is none.

        Raises:
            ConfigurationError: The storage cannot be used.
        """
        if not self.url:
            return None
        from drivora_service.store.traces.remote_traces import Storage

        return Storage(self.url, self.copies).probe
