"""The first difference of two traces, also as pandas finds it in their files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.observations.differences.trace_difference import (
    TraceDifference,
    trace_difference,
)
from drivora_service.observations.trace import (
    Actor,
    Contact,
    EgoCol,
    Light,
    LogEvent,
    Role,
    TerminalEvent,
    Trace,
)
from drivora_service.observations.trace_files.trace_file import read_trace, write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from tests.observations.conftest import STEPS, make_full_trace
from tests.observations.trace_files.test_trace_hash import CHANGES

FULL = make_full_trace()
ARRAYS = ("times", "states", "present", "ego_values", "ego_lanes", "ego_lights", "log_values")


def found(original: Trace, replayed: Trace) -> TraceDifference:
    difference = trace_difference(original, replayed)
    assert difference is not None
    return difference


def signals(difference: TraceDifference) -> list[tuple[str, str, object, object]]:
    return [(s.actor, s.signal, s.original, s.replayed) for s in difference.signals]


def test_equal_traces_have_no_difference_also_from_files(full_trace: Trace, tmp_path: Path) -> None:
    assert trace_difference(full_trace, full_trace) is None
    write_trace(full_trace, tmp_path / "trace.parquet")
    assert trace_difference(full_trace, read_trace(tmp_path / "trace.parquet")) is None


def test_bits_that_mean_the_same_are_no_difference(full_trace: Trace) -> None:
    values = full_trace.ego_values.copy()
    values[np.isnan(values)] = -np.float64(np.nan)
    values[values == 0.0] = -0.0
    states = full_trace.states.copy()
    states[~full_trace.present] = 4.0
    same = replace(full_trace, ego_values=values, states=states, meta={"host": "elsewhere"})
    assert trace_difference(full_trace, same) is None


@pytest.mark.parametrize("name", CHANGES)
def test_whatever_changes_the_hash_is_a_difference(full_trace: Trace, name: str) -> None:
    changed = CHANGES[name](full_trace)
    assert found(full_trace, changed) != found(changed, full_trace)


@st.composite
def cells(draw: st.DrawFn) -> tuple[str, tuple[int, ...]]:
    """An array of a trace and a place in it."""
    name = draw(st.sampled_from(ARRAYS))
    shape = getattr(FULL, name).shape
    return name, tuple(draw(st.integers(0, size - 1)) for size in shape)


@given(cell=cells(), far=st.booleans())
def test_a_changed_cell_is_found_exactly_there(
    cell: tuple[str, tuple[int, ...]], far: bool
) -> None:
    name, place = cell
    array = getattr(FULL, name).copy()
    before = array[place]
    if array.dtype == np.bool_:
        array[place] = not before
    elif array.dtype == np.uint8:
        array[place] = (before + 1) % len(Light)
    elif array.dtype == np.int32:
        array[place] = before + 1
    else:
        near = 1.0 if np.isnan(before) else np.nextafter(before, np.inf)
        array[place] = 1e6 if far else near
    changed = replace(FULL, **{name: array})
    difference = trace_difference(FULL, changed)
    assert (difference is None) == (trace_sha256(FULL) == trace_sha256(changed))
    if difference is None:
        # Only where an actor is not present does a value not count.
        assert name == "states"
        assert not FULL.present[place[:2]]
        return
    assert difference.facts == ()
    assert difference.step == place[0]
    (signal,) = difference.signals
    assert signal.actor == ("" if name == "times" else FULL.actors[place[1]].id)
    expected = {
        "times": "time",
        "present": "present",
        "ego_lanes": "lane",
        "ego_lights": "light",
    }.get(name)
    if name == "states":
        expected = ("x", "y", "yaw", "vx", "vy", "ax", "ay", "yaw_rate", "z")[place[2]]
    if name == "ego_values":
        expected = f"ego_{EgoCol(place[2]).name.lower()}"
    if name == "log_values":
        expected = f"log:{FULL.log_names[place[2]]}"
    assert signal.signal == expected
    values = (before, array[place])
    for told, value in zip((signal.original, signal.replayed), values, strict=True):
        if name == "ego_lights":
            assert told == ("none", "green", "yellow", "red")[value]
        elif (name == "ego_lanes" and value == -1) or value != value:
            assert told is None
        else:
            assert told == value


def first_by_pandas(one: Path, other: Path) -> tuple[int, set[tuple[str, str]]]:
    """Returns the first step at which two files differ, and the actors and columns that do."""
    frames = []
    for path in (one, other):
        table = pq.read_table(path)
        actors = pd.json_normalize(json.loads(table.schema.metadata[b"drivora_trace"])["actors"])
        frame = table.to_pandas()
        frame["actor"] = actors["id"].to_numpy()[frame["actor"]]
        frames.append(frame.set_index(["step", "actor"]))
    left, right = frames[0].align(frames[1], join="outer")
    unequal = (left != right) & ~(left.isna() & right.isna())
    rows = unequal[unequal.any(axis=1)]
    step = int(rows.index.get_level_values("step").min())
    return step, {
        (actor, column)
        for actor, flags in rows.loc[step].iterrows()
        for column in flags.index[flags]
    }


def test_a_course_that_diverges_is_found_as_pandas_finds_it(
    full_trace: Trace, tmp_path: Path
) -> None:
    rng = np.random.default_rng(5)
    for number in range(20):
        step = int(rng.integers(1, 55))
        values, states = full_trace.ego_values.copy(), full_trace.states.copy()
        logs = full_trace.log_values.copy()
        values[step:, 1, EgoCol.STEER] += rng.normal(0.0, 1e-12, STEPS - step)
        logs[step:, 0, 0] = np.nan
        states[step + 1 :, 1] += rng.normal(0.0, 1e-9, states[step + 1 :, 1].shape)
        states[step + 3 :, 0] += 0.5
        changed = replace(full_trace, ego_values=values, states=states, log_values=logs)
        paths = tmp_path / f"{number}-a.parquet", tmp_path / f"{number}-b.parquet"
        write_trace(full_trace, paths[0])
        write_trace(changed, paths[1])
        first, places = first_by_pandas(*paths)
        difference = found(*map(read_trace, paths))
        assert difference.step == first
        assert {(s.actor, s.signal) for s in difference.signals} == places
        assert difference.time == full_trace.times[first]
        assert difference.facts == ()


def test_an_actor_that_appears_earlier_is_present_and_the_rows_behind_it_move(
    full_trace: Trace,
) -> None:
    rows = {actor.id: actor.row for actor in full_trace.actors}
    walker, background = rows["actor-npc_walker"], rows["actor-background"]
    order = [*range(len(full_trace.actors))]
    order[walker], order[background] = background, walker
    present = full_trace.present.copy()
    present[7:, background] = present[:-7, background].copy()
    present[:7, background] = True
    actors = tuple(replace(full_trace.actors[old], row=row) for row, old in enumerate(order))
    changed = replace(
        full_trace,
        actors=actors,
        states=full_trace.states[:, order],
        present=present[:, order],
    )
    difference = found(full_trace, changed)
    assert difference.step == 0
    assert signals(difference) == [("actor-background", "present", False, True)]
    assert [one.fact for one in difference.facts] == ["order of actors"]


def test_an_actor_of_one_trace_only_is_told_by_its_first_row(full_trace: Trace) -> None:
    keeps = len(full_trace.actors) - 1
    fewer = replace(
        full_trace,
        actors=full_trace.actors[:keeps],
        states=full_trace.states[:, :keeps],
        present=full_trace.present[:, :keeps],
    )
    difference = found(full_trace, fewer)
    assert difference.step == 30
    assert signals(difference) == [("actor-background", "present", True, False)]
    assert difference.facts == ()
    never = Actor(
        row=keeps, id="ghost", role=Role.NPC_VEHICLE, model="synthetic", length=4.0, width=2.0
    )
    ghost = replace(
        fewer,
        actors=(*fewer.actors, never),
        states=np.concatenate([fewer.states, np.full((STEPS, 1, 9), np.nan)], axis=1),
        present=np.concatenate([fewer.present, np.zeros((STEPS, 1), dtype=np.bool_)], axis=1),
    )
    (fact,) = found(fewer, ghost).facts
    assert (fact.fact, fact.original, fact.replayed) == ("presence of ghost", "none", "never")


def test_a_traffic_light_is_told_by_its_state(full_trace: Trace) -> None:
    states = full_trace.light_states.copy()
    states[31:33] = states[40]
    difference = found(full_trace, replace(full_trace, light_states=states))
    assert difference.step == 31
    assert signals(difference) == [("junction", "state", "Gr", "rG")]


def test_events_are_told_at_their_steps(full_trace: Trace) -> None:
    other = replace(full_trace, log_events=(LogEvent(step=9, ego=1, message="late"),))
    difference = found(full_trace, other)
    assert difference.step == 4
    assert signals(difference) == [("two", "log line", full_trace.log_events[0].message, None)]
    other = replace(
        full_trace,
        contacts=(Contact(step=60, ego=0, other=3),),
        ego_ends=(TerminalEvent.STUCK, full_trace.ego_ends[1]),
    )
    difference = found(full_trace, other)
    assert difference.step == 60
    assert signals(difference) == [
        ("one", "contact", "actor-npc_vehicle", "actor-npc_walker"),
        ("one", "end", "collision", "stuck"),
    ]


def test_causes_come_before_effects(full_trace: Trace) -> None:
    values, states = full_trace.ego_values.copy(), full_trace.states.copy()
    values[20, 0, EgoCol.ACCELERATION] += 1.0
    states[20, 2, 0] += 1.0
    difference = found(full_trace, replace(full_trace, ego_values=values, states=states))
    assert [(s.actor, s.signal) for s in difference.signals] == [
        ("actor-npc_vehicle", "x"),
        ("one", "ego_acceleration"),
    ]


def test_a_longer_trace_differs_where_the_other_ends(full_trace: Trace, tmp_path: Path) -> None:
    short = 70
    cut = {name: getattr(full_trace, name)[:short] for name in (*ARRAYS, "light_states")}
    shorter = replace(full_trace, **cut, ego_end_steps=(60, short - 1))
    whole = replace(full_trace, ego_end_steps=(60, short - 1))
    difference = found(shorter, whole)
    assert difference.step == short
    assert difference.time == full_trace.times[short]
    assert signals(difference) == [("", "steps", short, STEPS)]
    # The end of an ego is earlier than the row that one trace lacks.
    difference = found(shorter, full_trace)
    assert difference.step == short - 1
    assert signals(difference) == [("two", "end", "time_limit", None)]


def test_a_log_column_of_one_trace_only_is_told_by_its_first_value(full_trace: Trace) -> None:
    fewer = replace(full_trace, log_names=("gap",), log_values=full_trace.log_values[:, :, :1])
    assert full_trace.log_names == ("gap", "target_speed")
    difference = found(full_trace, fewer)
    assert difference.step == 0
    assert signals(difference) == [("one", "log:target_speed", 8.0, None)]
    assert [one.fact for one in difference.facts] == ["log_names"]
