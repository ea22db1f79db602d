"""The protocol of a measurement, and what performs it.

A measurement is a module with a :class:`Measurement`. It prepares and warms up what it needs once,
then is asked for one round after another; within a round it takes turns between everything that is
compared, so that a machine that changes its speed changes it for all.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.suite.result import Better, Quantity, Section, Series


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """One value of a quantity in one round."""

    quantity: Quantity
    value: float


def sample(
    case: str, name: str, value: float, unit: str = "", better: Better = Better.LOWER
) -> Sample:
    """Returns a value of a quantity."""
    quantity = Quantity(case=case, name=name, unit=unit, better=better)
    return Sample(quantity=quantity, value=value)


Round = Callable[[], Iterable[Sample]]
"""Performs one round."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The extent of the measurements.

    Attributes:
        short: Whether only to show that everything runs.
        rounds: Number of rounds.
        simulations: Budget of a campaign.
        networks: Folder of further networks, ``NAME.net.xml``; ``None``: shipped ones only.
        routes: Route file of CARLA's Leaderboard 1.0 for them.
        cache: Folder for the environments of peers.
        folder: For files of the measurement; removed afterwards.
        remarks: Receives sentences about what is left out.
    """

    short: bool
    rounds: int
    simulations: int
    networks: Path | None
    routes: Path | None
    cache: Path
    folder: Path
    remarks: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """One measurement of the suite.

    Attributes:
        name: Name for the command line and the result.
        title: Heading of its part of the page.
        about: What is measured, and how.
        open: Prepares; returns what performs one round, until it is closed.
    """

    name: str
    title: str
    about: str
    open: Callable[[Plan], AbstractContextManager[Round]]


def perform(measurement: Measurement, plan: Plan) -> Section:
    """Performs the rounds of a measurement."""
    begun, load = time.monotonic(), os.getloadavg()[0]
    values: dict[Quantity, list[float]] = {}
    with measurement.open(plan) as once:
        for _ in range(plan.rounds):
            for one in once():
                values.setdefault(one.quantity, []).append(one.value)
    return Section(
        name=measurement.name,
        title=measurement.title,
        about=measurement.about,
        load=round(load, 2),
        seconds=round(time.monotonic() - begun, 1),
        series=tuple(Series(quantity=q, values=tuple(v)) for q, v in values.items()),
        remarks=tuple(plan.remarks),
    )
