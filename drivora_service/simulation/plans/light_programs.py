"""Running light programmes with fixed times, which are known for every step without SUMO.

The times of a document replace the phase durations of the network's programmes; their states
remain, since they keep a junction free of conflicts. So the state of a signal is computed directly.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import SignalPhase, SignalProgram, make_read_only
from drivora_service.observations.trace import Light
from drivora_service.scenario.model import LightTimes, TrafficLights

_MIN_PHASE = 1.0
_CODES: Mapping[str, Light] = {
    "G": Light.GREEN,
    "g": Light.GREEN,
    "y": Light.YELLOW,
    "u": Light.RED,
    "r": Light.RED,
}


def light_of(signal: str) -> Light:
    """Returns the ``Light`` of SUMO's letter; a signal that is off counts as none."""
    return _CODES.get(signal, Light.NONE)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunningProgram:
    """A programme with fixed times.

    Attributes:
        id: The traffic light.
        phases: Stages in order.
        ends: (p,) end of each stage within the cycle, seconds; the last is the cycle.
        offset: Seconds by which the programme is delayed.
    """

    id: str
    phases: tuple[SignalPhase, ...]
    ends: FloatArray
    offset: float

    def phase_at(self, times: FloatArray) -> NDArray[np.int64]:
        """Returns the (n,) index of the stage shown at each of (n,) times, seconds."""
        in_cycle = np.mod(times - self.offset + 1e-9, self.ends[-1])
        phases = np.searchsorted(self.ends, in_cycle, side="right")
        shown: NDArray[np.int64] = np.minimum(phases, len(self.phases) - 1).astype(np.int64)
        return shown

    def stage_at(self, time: float) -> tuple[int, float]:
        """Returns the index of the stage shown at ``time``, and the seconds to its end."""
        ends: list[float] = self.ends.tolist()
        in_cycle = (time - self.offset + 1e-9) % ends[-1]
        phase = min(bisect_right(ends, in_cycle), len(self.phases) - 1)
        return phase, max(ends[phase] - in_cycle, 1e-3)


def longest_wait(program: RunningProgram, link_index: int) -> float:
    """Returns the maximum seconds without green for a movement, 0 for one without a signal.

    Also 0 for a movement that never has green, which no vehicle can pass in time.
    """
    lights = [light_of(phase.state[link_index]) for phase in program.phases]
    waiting = [light in (Light.YELLOW, Light.RED) for light in lights]
    if all(waiting) or not any(waiting):
        return 0.0
    first = waiting.index(False)
    longest = wait = 0.0
    for i in range(first, first + len(waiting)):
        at = i % len(waiting)
        wait = wait + program.phases[at].duration if waiting[at] else 0.0
        longest = max(longest, wait)
    return longest


def _is_yellow(phase: SignalPhase) -> bool:
    return "y" in phase.state or "u" in phase.state


def _is_green(phase: SignalPhase) -> bool:
    return not _is_yellow(phase) and any(letter in "Gg" for letter in phase.state)


@lru_cache(maxsize=1024)
def run_program(
    program: SignalProgram, times: LightTimes, *, step_length: float = 0.05
) -> RunningProgram:
    """Returns a network's programme with the times of a document.

    Consecutive stages that show green (and no yellow), for example if the walkers' green ends
    before the cars', last ``green`` together, in their original proportions; every stage with a
    yellow lasts ``yellow``. With two greens, ``red`` is the time between the greens of the first
    group of signals: the second green is adapted. With one, it is the duration of the all-red
    stage. With more, red follows from the others. SUMO switches at steps, so every time is a whole
    number of steps. Cached, since most runs of a search share their times.
    """
    greens = _greens(program)
    yellows = [i for i, phase in enumerate(program.phases) if _is_yellow(phase)]
    durations = [phase.duration for phase in program.phases]
    if times.green is not None:
        for green in greens:
            _share(durations, green, times.green)
    if times.yellow is not None:
        for i in yellows:
            durations[i] = times.yellow
    if times.red is not None and len(program.phases) > 1:
        if len(greens) == 2:
            # The clearing yellow directly after the first green does not count as red.
            counted = {*greens[0], *greens[1], (greens[0][-1] + 1) % len(durations)}
            others = sum(durations[i] for i in range(len(durations)) if i not in counted)
            _share(durations, greens[1], times.red - others)
        elif len(greens) == 1:
            dark = [i for i in range(len(durations)) if i not in greens[0] and i not in yellows]
            for i in dark:
                durations[i] = times.red / len(dark)
    durations = [_whole_steps(max(duration, _MIN_PHASE), step_length) for duration in durations]
    ends = np.cumsum(np.array(durations))
    make_read_only(ends)
    return RunningProgram(
        id=program.id,
        phases=tuple(
            SignalPhase(duration=duration, state=phase.state)
            for duration, phase in zip(durations, program.phases, strict=True)
        ),
        ends=ends,
        offset=_whole_steps(program.offset if times.offset is None else times.offset, step_length),
    )


def _greens(program: SignalProgram) -> list[list[int]]:
    """Returns the stages of each green: runs of stages that show green and no yellow."""
    greens: list[list[int]] = []
    for i, phase in enumerate(program.phases):
        if not _is_green(phase):
            continue
        if greens and greens[-1][-1] == i - 1:
            greens[-1].append(i)
        else:
            greens.append([i])
    return greens


def _whole_steps(seconds: float, step_length: float) -> float:
    return round(round(seconds / step_length) * step_length, 6)


def _share(durations: list[float], stages: Sequence[int], together: float) -> None:
    """Scales the durations of stages to a sum of ``together`` seconds."""
    before = sum(durations[i] for i in stages)
    for i in stages:
        durations[i] *= together / before


def run_programs(
    programs: Mapping[str, SignalProgram], lights: TrafficLights, *, step_length: float = 0.05
) -> tuple[RunningProgram, ...]:
    """Returns the running programmes of a network; a junction's own times override the common ones.

    Raises:
        KeyError: If ``lights`` names a junction without a programme; validation rules that out.
    """
    return tuple(
        run_program(
            program,
            _merge_times(lights.times, lights.junctions.get(light_id)),
            step_length=step_length,
        )
        for light_id, program in sorted(programs.items())
    )


def _merge_times(common: LightTimes, own: LightTimes | None) -> LightTimes:
    if own is None:
        return common
    return LightTimes(
        green=common.green if own.green is None else own.green,
        yellow=common.yellow if own.yellow is None else own.yellow,
        red=common.red if own.red is None else own.red,
        offset=common.offset if own.offset is None else own.offset,
    )
