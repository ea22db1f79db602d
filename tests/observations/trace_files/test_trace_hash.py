from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from drivora_service.observations.trace import Col, Contact, LogEvent, TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import egos_sha256, trace_sha256


def test_equal_traces_have_equal_hashes(full_trace: Trace) -> None:
    copied = replace(full_trace, states=full_trace.states.copy(), meta={"host": "elsewhere"})
    assert trace_sha256(copied) == trace_sha256(full_trace)


def test_memory_layout_does_not_matter(full_trace: Trace) -> None:
    roomy = np.zeros((500, 20, len(Col)))
    roomy[: full_trace.step_count, : len(full_trace.actors)] = full_trace.states
    view = roomy[: full_trace.step_count, : len(full_trace.actors)]
    fortran = np.asfortranarray(full_trace.ego_values)
    changed = replace(full_trace, states=view, ego_values=fortran)
    assert trace_sha256(changed) == trace_sha256(full_trace)


def test_bits_that_mean_the_same_are_the_same(full_trace: Trace) -> None:
    values = full_trace.ego_values.copy()
    values[np.isnan(values)] = -np.float64(np.nan)
    values[values == 0.0] = -0.0
    assert values.tobytes() != full_trace.ego_values.tobytes()
    assert trace_sha256(replace(full_trace, ego_values=values)) == trace_sha256(full_trace)


def test_rows_of_absent_actors_do_not_matter(full_trace: Trace) -> None:
    states = full_trace.states.copy()
    states[~full_trace.present] = 4.0
    assert trace_sha256(replace(full_trace, states=states)) == trace_sha256(full_trace)


def _changed(name: str) -> Callable[[Trace], Trace]:
    def change(trace: Trace) -> Trace:
        array = getattr(trace, name).copy()
        flat = array.reshape(-1)
        place = int(np.flatnonzero(flat == flat)[0])
        flat[place] = not flat[place] if array.dtype == np.bool_ else flat[place] + 1
        return replace(trace, **{name: array})

    return change


CHANGES: dict[str, Callable[[Trace], Trace]] = {
    "network": lambda t: replace(t, network="other"),
    "network_sha256": lambda t: replace(t, network_sha256="f" * 64),
    "scenario_sha256": lambda t: replace(t, scenario_sha256="f" * 64),
    "step_length": lambda t: replace(t, step_length=0.1),
    "times": _changed("times"),
    "actors": lambda t: replace(t, actors=(replace(t.actors[0], length=5.0), *t.actors[1:])),
    "states": _changed("states"),
    "present": _changed("present"),
    "ego_values": _changed("ego_values"),
    "ego_lanes": _changed("ego_lanes"),
    "ego_lights": _changed("ego_lights"),
    "ego_routes": lambda t: replace(
        t, ego_routes=(replace(t.ego_routes[0], line=t.ego_routes[0].line + 1e-9), t.ego_routes[1])
    ),
    "ego_start_times": lambda t: replace(t, ego_start_times=(0.5, 1.0)),
    "ego_ends": lambda t: replace(t, ego_ends=(TerminalEvent.STUCK, t.ego_ends[1])),
    "ego_end_steps": lambda t: replace(t, ego_end_steps=(61, 79)),
    "contacts": lambda t: replace(t, contacts=(Contact(step=60, ego=0, other=3),)),
    "light_ids": lambda t: replace(t, light_ids=("elsewhere",)),
    "light_states": _changed("light_states"),
    "light_state_names": lambda t: replace(t, light_state_names=("gr", "rG")),
    "log_names": lambda t: replace(t, log_names=("gap", "other")),
    "log_values": _changed("log_values"),
    "log_events": lambda t: replace(t, log_events=(LogEvent(step=4, ego=1, message="other"),)),
    "privileged": lambda t: replace(t, privileged=(True, False)),
    "max_sim_time": lambda t: replace(t, max_sim_time=60.0),
}


@pytest.mark.parametrize("name", CHANGES)
def test_every_physical_fact_matters(full_trace: Trace, name: str) -> None:
    assert trace_sha256(CHANGES[name](full_trace)) != trace_sha256(full_trace)


def test_no_field_of_the_trace_was_forgotten() -> None:
    left_out = {"meta", "lane_ids", "plans", "references"}
    assert {field.name for field in fields(Trace)} == {*CHANGES, *left_out}


def moved(trace: Trace, row: int, step: int) -> Trace:
    states = trace.states.copy()
    states[step, row, Col.X] += 1e-9
    return replace(trace, states=states)


def test_the_hash_of_the_egos_is_theirs_alone(full_trace: Trace) -> None:
    own = egos_sha256(full_trace)
    egos = full_trace.ego_count
    for row in range(egos, len(full_trace.actors)):
        here = int(np.flatnonzero(full_trace.present[:, row])[0])
        assert egos_sha256(moved(full_trace, row, here)) == own
        assert trace_sha256(moved(full_trace, row, here)) != trace_sha256(full_trace)
    for row in range(egos):
        assert egos_sha256(moved(full_trace, row, 5)) != own


def test_what_an_ego_does_after_its_end_does_not_matter(full_trace: Trace) -> None:
    end = full_trace.ego_end_steps[0]
    assert egos_sha256(moved(full_trace, 0, end + 1)) == egos_sha256(full_trace)
    assert egos_sha256(moved(full_trace, 0, end)) != egos_sha256(full_trace)


@pytest.mark.parametrize(
    "change",
    [
        {"ego_ends": (TerminalEvent.STUCK, TerminalEvent.ARRIVED)},
        {"ego_end_steps": (59, 79)},
        {"ego_start_times": (0.5, 1.0)},
        {"step_length": 0.1},
    ],
    ids=lambda change: next(iter(change)),
)
def test_how_an_ego_ends_and_begins_matters(full_trace: Trace, change: dict[str, Any]) -> None:
    assert egos_sha256(replace(full_trace, **change)) != egos_sha256(full_trace)


def test_other_scenarios_with_the_same_egos_have_the_same_hash(full_trace: Trace) -> None:
    other = replace(full_trace, scenario_sha256="f" * 64, log_events=(), contacts=())
    assert egos_sha256(other) == egos_sha256(full_trace)
