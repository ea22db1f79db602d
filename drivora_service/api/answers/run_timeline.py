"""The time line of a run: violations, signals, actors and agents' logs by step."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from drivora_service.api.schemas.timeline import (
    ActorPresence,
    Approach,
    EgoPart,
    LightPhase,
    LogLine,
    MetLight,
    StepSpan,
    Timeline,
    ViolationMark,
)
from drivora_service.geometry.array_shapes import ByteArray
from drivora_service.networks.stop_lines import stop_lines
from drivora_service.observations.recorded_signals import signal_in_run
from drivora_service.observations.route_signals import met_signals
from drivora_service.observations.run_view import RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import Light
from drivora_service.oracles.verdicts.accountability import accountability
from drivora_service.oracles.verdicts.violation_marks import marks_of, moments_of
from drivora_service.store.runs.run_records import RunRecord

MOST_LOG_LINES = 5000


def timeline_of(record: RunRecord, view: RunView) -> Timeline:
    """Returns the time line of a run."""
    trace = view.trace
    return Timeline(
        run_id=record.id,
        network=trace.network,
        steps=trace.step_count,
        step_length=trace.step_length,
        duration=float(trace.times[-1] - trace.times[0]),
        egos=tuple(_egos(record, view)),
        actors=tuple(
            ActorPresence(
                row=actor.row,
                id=actor.id,
                role=actor.role,
                model=actor.model,
                length=actor.length,
                width=actor.width,
                present=tuple(
                    StepSpan(first=first, last=stop - 1)
                    for first, stop in stretches(trace.present[:, actor.row])
                ),
            )
            for actor in trace.actors
        ),
        violations=tuple(_violations(record, trace.step_length, trace.step_count)),
        lights=tuple(_lights(view)),
        log=tuple(
            LogLine(step=event.step, ego=trace.actors[event.ego].id, message=event.message)
            for event in sorted(trace.log_events, key=lambda event: event.step)[:MOST_LOG_LINES]
        ),
        log_lines=len(trace.log_events),
    )


def _egos(record: RunRecord, view: RunView) -> Iterator[EgoPart]:
    for ego in view.egos:
        choice = record.agents.get(ego.id)
        yield EgoPart(
            row=ego.row,
            id=ego.id,
            agent="" if choice is None else choice.name,
            first=ego.first,
            last=ego.first + ego.count - 1,
            end=ego.end,
            privileged=view.trace.privileged[ego.row],
            route_length=ego.route.length,
        )


def _violations(record: RunRecord, step_length: float, steps: int) -> Iterator[ViolationMark]:
    for mark in marks_of(record.verdicts):
        verdict = mark.verdict
        moments = moments_of(verdict, step_length)
        yield ViolationMark(
            number=mark.number,
            oracle=verdict.oracle,
            ego=verdict.ego,
            message=verdict.message,
            severity=verdict.severity,
            at_fault=verdict.at_fault,
            accountability=accountability(verdict),
            avoidable=verdict.avoidable,
            physically_avoidable=verdict.physically_avoidable,
            counterpart=verdict.counterpart,
            location=verdict.location,
            first=None if moments is None else moments.first,
            last=None if moments is None else min(moments.last, steps - 1),
            risk_perceived=None if moments is None else moments.risk_perceived,
            avoidable_until=None if moments is None else moments.avoidable_until,
        )


def _lights(view: RunView) -> Iterator[MetLight]:
    """Returns the signals that egos met, each once, in the order of the first meeting."""
    lanes = stop_lines(view.network).lanes
    met: dict[tuple[str, int, int], list[Approach]] = {}
    phases: dict[tuple[str, int, int], tuple[LightPhase, ...]] = {}
    for ego in view.egos:
        for signal in met_signals(ego):
            shown = signal_in_run(view.trace, signal.connection)
            if shown is None:
                continue
            connection = signal.connection
            key = connection.traffic_light, connection.link_index, int(lanes[signal.line])
            phases.setdefault(key, _phases(shown))
            met.setdefault(key, []).append(
                Approach(
                    ego=ego.row,
                    first=ego.first + signal.first,
                    last=ego.first + signal.last,
                    passed=None if signal.passed is None else ego.first + signal.passed,
                )
            )
    for key, approaches in sorted(met.items(), key=lambda item: item[1][0].first):
        light, link, lane = key
        yield MetLight(
            id=light,
            link=link,
            lane=view.network.lanes[lane].id,
            approaches=tuple(approaches),
            phases=phases[key],
        )


def _phases(shown: ByteArray) -> tuple[LightPhase, ...]:
    bounds = [0, *(np.flatnonzero(np.diff(shown)) + 1).tolist(), len(shown)]
    return tuple(
        LightPhase(first=first, last=stop - 1, light=Light(int(shown[first])).name.lower())
        for first, stop in itertools.pairwise(bounds)
    )
