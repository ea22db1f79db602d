"""Figures for Prometheus, read from the store when they are asked for."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from prometheus_client import CollectorRegistry, disable_created_metrics, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.registry import Collector

from drivora_service.api.context import ApiContext
from drivora_service.api.guards.client_counts import ClientCounts
from drivora_service.api.guards.request_times import RequestTimes
from drivora_service.errors import StoreDamaged
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.runs.run_records import OwnerRecord

CONTENT_TYPE = CONTENT_TYPE_LATEST


def metrics_text(context: ApiContext, times: RequestTimes, clients: ClientCounts) -> bytes:
    """Returns the metrics in Prometheus' text form."""
    # Times of creation double the series, and Prometheus reads none of them in this form.
    disable_created_metrics()  # type: ignore[no-untyped-call]  # The package does not type it.
    registry = CollectorRegistry(auto_describe=False)
    registry.register(_FaultCollector(context))
    registry.register(_StoreCollector(context))
    return b"".join(map(generate_latest, (registry, times.registry, clients.registry)))


class _FaultCollector(Collector):
    def __init__(self, context: ApiContext) -> None:
        self._context = context

    def collect(self) -> Iterator[Metric]:
        found = self._context.faults()
        ready = GaugeMetricFamily("drivora_ready", "Whether /readyz answers 200")
        ready.add_metric([], float(not any(found.values())))
        faults = GaugeMetricFamily(
            "drivora_fault", "Whether a check of /readyz fails", labels=["check"]
        )
        for name, fault in found.items():
            faults.add_metric([name], float(bool(fault)))
        yield from (ready, faults)
        free = GaugeMetricFamily(
            "drivora_traces_free_bytes", "Free bytes of the volume that holds the traces"
        )
        with contextlib.suppress(OSError):
            free.add_metric(
                [],
                shutil.disk_usage(
                    _find_existing_folder(self._context.campaign_folder("0").path)
                ).free,
            )
        yield free


class _StoreCollector(Collector):
    def __init__(self, context: ApiContext) -> None:
        self._context = context

    def collect(self) -> Iterator[Metric]:
        try:
            with self._context.database.read() as transaction:
                counts = transaction.jobs.counts()
                owners = transaction.workers.living_owners()
                figures = transaction.figures.figures()
        except StoreDamaged:
            # The fault is among the other figures, which must not be lost with these.
            return
        runs = GaugeMetricFamily("drivora_runs", "Runs by status", labels=["status"])
        for status, count in counts.items():
            runs.add_metric([status.value], count)
        failures = GaugeMetricFamily(
            "drivora_failed_runs",
            "Runs that did not finish, by status and cause",
            labels=["status", "cause"],
        )
        for (status, cause), count in figures.failures.items():
            failures.add_metric([status.value, cause], count)
        depth = GaugeMetricFamily("drivora_queue_depth", "Runs that wait, paused batches included")
        depth.add_metric([], counts[RunStatus.QUEUED])
        oldest = GaugeMetricFamily(
            "drivora_queue_oldest_age_seconds",
            "Age of the oldest run that waits in a batch that is not paused; 0 without one",
        )
        oldest.add_metric([], _age(figures.oldest_queued_at))
        quarantined = GaugeMetricFamily(
            "drivora_quarantined_scenarios", "Scenarios that crash the simulator"
        )
        quarantined.add_metric([], figures.quarantined)
        size = GaugeMetricFamily("drivora_database_bytes", "Size of the database")
        size.add_metric([], figures.database_bytes)
        yield from (runs, failures, depth, oldest, quarantined, size)
        yield from _slots(owners)


def _slots(owners: tuple[OwnerRecord, ...]) -> Iterator[Metric]:
    busy = GaugeMetricFamily(
        "drivora_slot_busy", "Whether a worker slot runs something", labels=["slot"]
    )
    memory = GaugeMetricFamily(
        "drivora_slot_memory_bytes", "Memory of a slot's worker", labels=["slot"]
    )
    restarts = CounterMetricFamily(
        "drivora_slot_restarts", "Worker processes replaced", labels=["slot"]
    )
    for slot in (slot for owner in owners for slot in owner.slots):
        busy.add_metric([slot.name], float(bool(slot.run_id)))
        memory.add_metric([slot.name], slot.memory_bytes)
        restarts.add_metric([slot.name], slot.restarts)
    yield from (busy, memory, restarts)


def _age(moment: datetime | None) -> float:
    if moment is None:
        return 0.0
    return max((datetime.now(UTC) - moment).total_seconds(), 0.0)


def _find_existing_folder(path: Path) -> Path:
    """Returns the nearest folder around a path that is there."""
    return next(folder for folder in path.absolute().parents if folder.is_dir())
