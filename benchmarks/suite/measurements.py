"""The measurements of the suite, in the order of measuring."""

from __future__ import annotations

from benchmarks.suite.api_requests import API
from benchmarks.suite.campaign_throughput import CAMPAIGNS
from benchmarks.suite.measurement import Measurement
from benchmarks.suite.peers import PEERS
from benchmarks.suite.raster_cost import RASTER_COST
from benchmarks.suite.run_floor import RUN_FLOOR
from benchmarks.suite.service_overhead import SERVICE
from benchmarks.suite.step_cost import STEP_COST
from benchmarks.suite.validation import VALIDATION

MEASUREMENTS: tuple[Measurement, ...] = (
    STEP_COST,
    RASTER_COST,
    RUN_FLOOR,
    CAMPAIGNS,
    SERVICE,
    VALIDATION,
    API,
    PEERS,
)
