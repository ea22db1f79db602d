"""Egos that SUMO itself drives: the baselines against which an ADS is compared."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SumoDriver:
    """One of SUMO's drivers, in place of an agent that is asked every step.

    Attributes:
        type_id: Vehicle type in ``simulation/driver_types.add.xml``: car-following model and
            lane-change model.
    """

    type_id: str
