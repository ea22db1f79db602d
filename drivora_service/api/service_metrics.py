"""Counts for Prometheus, read from the store when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.registry import Collector

from drivora_service.api.context import ApiContext

CONTENT_TYPE = CONTENT_TYPE_LATEST


def metrics_text(context: ApiContext) -> bytes:
    """Gives the metrics in Prometheus' text form."""
    registry = CollectorRegistry(auto_describe=False)
    registry.register(_StoreCollector(context))
    return generate_latest(registry)


class _StoreCollector(Collector):
    def __init__(self, context: ApiContext) -> None:
        self._context = context

    def collect(self) -> Iterator[Metric]:
        with self._context.database.read() as transaction:
            counts = transaction.jobs.counts()
            owners = transaction.workers.living()
        runs = GaugeMetricFamily("drivora_runs", "Runs by status", labels=["status"])
        for status, count in counts.items():
            runs.add_metric([status.value], count)
        yield runs
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
