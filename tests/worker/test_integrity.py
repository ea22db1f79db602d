"""Changes by an agent to the code that simulates and judges are found, and named."""

from __future__ import annotations

import builtins
import ctypes
import decimal
import importlib
import inspect
import json
import math
import platform
import random
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.built_in_agents import BUILT_IN
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin
from drivora_service.feedback.measurement import Feedback, FeedbackChoice, Measurement
from drivora_service.metrics import driving_score
from drivora_service.metrics.built_in_metrics import measure
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.observations import local_polynomials
from drivora_service.observations.run_view import RunView
from drivora_service.oracles import blocked
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.simulation import trace_assembly
from drivora_service.simulation.motion import step_kernels
from drivora_service.worker import measuring, objective_measuring, performing
from drivora_service.worker.integrity import snapshot_judging_code
from drivora_service.worker.setup import WorkerSetup
from tests.simulation.episodes import ego, place, scenario

SETUP = WorkerSetup(shipped_networks=shipped_networks(), installed_oracles=False)
_FTZ_AND_DAZ = 0x8040
"""Bits of MXCSR, the control word of SSE, that make denormal numbers zero."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A change that code can make to its process, its undoing, and its name."""

    do: Callable[[], object]
    undo: Callable[[], object]
    said: str


def replaced(owner: Any, name: str, value: object, said: str) -> Change:
    absent = object()
    before = vars(owner).get(name, absent)

    def undo() -> None:
        if before is absent:
            delattr(owner, name)
        else:
            setattr(owner, name, before)

    return Change(do=lambda: setattr(owner, name, value), undo=undo, said=said)


def no_verdicts(self: object, run: RunView) -> tuple[()]:
    return ()


def code_of_a_function() -> Change:
    function = RunView.__init__
    code = function.__code__
    return Change(
        do=lambda: setattr(function, "__code__", no_verdicts.__code__),
        undo=lambda: setattr(function, "__code__", code),
        said="the code of drivora_service.observations.run_view.RunView.__init__",
    )


def default_of_a_function() -> Change:
    function: Any = measure
    before = function.__kwdefaults__
    return Change(
        do=lambda: setattr(function, "__kwdefaults__", {"view": 3}),
        undo=lambda: setattr(function, "__kwdefaults__", before),
        said="the keyword defaults of drivora_service.metrics.built_in_metrics.measure",
    )


def entry_of_a_table() -> Change:
    table: Any = driving_score.TARIFFS
    key, value = next(iter(table.items()))
    return Change(
        do=lambda: table.update({key: 0.0}),
        undo=lambda: table.update({key: value}),
        said=f"drivora_service.metrics.driving_score.TARIFFS.{key}",
    )


def errors_of_numpy() -> Change:
    before = np.geterr()
    return Change(
        do=lambda: np.seterr(all="raise"), undo=lambda: np.seterr(**before), said="seterr"
    )


def fatal_warning() -> Change:
    before = list(warnings.filters)

    def undo() -> None:
        warnings.filters[:] = before  # type: ignore[index] # a list

    return Change(
        do=lambda: warnings.simplefilter("error", ResourceWarning),
        undo=undo,
        said="the filters that turn warnings into errors",
    )


def recursion_limit() -> Change:
    before = sys.getrecursionlimit()
    return Change(
        do=lambda: sys.setrecursionlimit(before + 77),
        undo=lambda: sys.setrecursionlimit(before),
        said="the recursion limit",
    )


def decimal_context() -> Change:
    before = decimal.getcontext().copy()
    return Change(
        do=lambda: setattr(decimal.getcontext(), "prec", 3),
        undo=lambda: decimal.setcontext(before),
        said="decimal arithmetic",
    )


CHANGES: Mapping[str, Callable[[], Change]] = {
    "a method of an oracle": lambda: replaced(
        Collision, "judge", no_verdicts, "drivora_service.oracles.collision.Collision.judge"
    ),
    "a constant": lambda: replaced(
        blocked, "STANDING_SPEED", 0.5, "drivora_service.oracles.blocked.STANDING_SPEED"
    ),
    "a module that an oracle uses": lambda: replaced(
        blocked, "np", math, "drivora_service.oracles.blocked.np"
    ),
    "a name that hides a built-in one": lambda: replaced(
        blocked, "max", min, "drivora_service.oracles.blocked.max"
    ),
    "an attribute that hides an inherited one": lambda: replaced(
        Outcome, "__eq__", no_verdicts, "drivora_service.oracles.verdict.Outcome.__eq__"
    ),
    "a function of NumPy": lambda: replaced(np, "hypot", np.add, "numpy.hypot"),
    "a function behind one of NumPy": lambda: replaced(
        sys.modules["numpy._core.fromnumeric"], "_wrapfunc", max, "fromnumeric._wrapfunc"
    ),
    "a function behind the filters of motion": lambda: replaced(
        local_polynomials, "correlate", max, "local_polynomials.correlate"
    ),
    "a function of math": lambda: replaced(math, "atan2", max, "math.atan2"),
    "a function of json": lambda: replaced(json, "dumps", repr, "json.dumps"),
    "a built-in function": lambda: replaced(builtins, "min", max, "builtins.min"),
    "a kernel": lambda: replaced(
        step_kernels, "make_frame", max, "drivora_service.simulation.motion.step_kernels.make_frame"
    ),
    "the source of a kernel": lambda: replaced(
        step_kernels.make_frame, "function", max, "the kernel drivora_service.simulation"
    ),
    "the source of the machine code of a kernel": lambda: replaced(
        vars(step_kernels.make_frame)["dispatcher"],
        "py_func",
        max,
        "the kernel drivora_service.simulation",
    ),
    "the machine code of a kernel": lambda: replaced(
        step_kernels.make_frame, "dispatcher", max, "the kernel drivora_service.simulation"
    ),
    "the code of a function": code_of_a_function,
    "the defaults of a function": default_of_a_function,
    "a table": entry_of_a_table,
    "NumPy's errors": errors_of_numpy,
    "warnings": fatal_warning,
    "the recursion limit": recursion_limit,
    "decimal arithmetic": decimal_context,
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_is_found_and_named(name: str) -> None:
    # A kernel has machine code that could be exchanged once it has been called.
    assert step_kernels.make_frame.dispatcher is not None  # type: ignore[attr-defined]  # a compiled function has it
    code = snapshot_judging_code()
    assert code.changes() == ()
    change = CHANGES[name]()
    change.do()
    try:
        found = code.changes()
    finally:
        change.undo()
    assert any(change.said in what for what in found), found
    assert code.changes() == ()


class ControlWord:
    """The floating-point environment of this thread, by the C library."""

    def __init__(self) -> None:
        self.library = ctypes.CDLL(None)
        self.kept = (ctypes.c_uint32 * 8)()
        self.library.fegetenv(self.kept)

    def flush_to_zero(self) -> None:
        changed = (ctypes.c_uint32 * 8)(*self.kept)
        changed[7] |= _FTZ_AND_DAZ
        self.library.fesetenv(changed)

    def round_up(self) -> None:
        self.library.fesetround(0x800)

    def restore(self) -> None:
        self.library.fesetenv(self.kept)


@pytest.mark.skipif(
    platform.machine() != "x86_64" or sys.platform != "linux",
    reason="the control word is that of SSE, as glibc lays it out",
)
@pytest.mark.parametrize(
    ("change", "said"),
    [(ControlWord.flush_to_zero, "denormal numbers"), (ControlWord.round_up, "rounds")],
)
def test_a_native_library_that_changes_the_arithmetic_is_found(
    change: Callable[[ControlWord], None], said: str
) -> None:
    code, word = snapshot_judging_code(), ControlWord()
    change(word)
    try:
        found = code.changes()
    finally:
        word.restore()
    assert len(found) == 1
    assert said in found[0]
    assert code.changes() == ()


def test_what_is_loaded_or_compiled_later_is_no_change_and_compared_from_then_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "drivora_service.scenario.exporting", raising=False)
    monkeypatch.delattr("drivora_service.scenario.exporting", raising=False)
    code = snapshot_judging_code()
    assert code.changes() == ()
    (tmp_path / "loaded_late.py").write_text("import warnings\nwarnings.filterwarnings('ignore')\n")
    monkeypatch.syspath_prepend(tmp_path)
    with warnings.catch_warnings():
        importlib.import_module("loaded_late")
        late = importlib.import_module("drivora_service.scenario.exporting")
        assert code.changes() == ()
    name = next(name for name, value in vars(late).items() if inspect.isfunction(value))
    monkeypatch.setattr(late, name, max)
    assert f"drivora_service.scenario.exporting.{name}" in code.changes()


class Meddler(IdmAgent):
    """Drives like ``idm``, and changes something in its sixth step."""

    def __init__(self, do: Callable[[], object]) -> None:
        super().__init__()
        self._do = do

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.step == 5:
            self._do()
        return super().run_step(observation)


@pytest.fixture
def drive(monkeypatch: pytest.MonkeyPatch) -> Callable[..., RunReport]:
    """Performs a run of a second with an agent that does something."""

    def perform(do: Callable[[], object], **more: Any) -> RunReport:
        entry = AgentEntry(
            name="meddler", kind=AgentKind.BASELINE, description="", source="", licence=""
        )
        plugin = AgentPlugin(entry=entry, create=lambda parameters: Meddler(do))
        catalogue = AgentCatalogue((*BUILT_IN, plugin))
        monkeypatch.setattr(performing, "agents_of", lambda setup: catalogue)
        snapshot_judging_code.cache_clear()
        start, end = place("harbour_1_0", 20), place("harbour_1_0", 120)
        what = scenario(ego(start, end, agent="meddler"), seconds=1.0)
        return performing.perform(
            RunSpec(run_id="run", document=canonical_json(what), **more), SETUP
        )

    return perform


@pytest.mark.parametrize("name", ["a method of an oracle", "a function of NumPy", "a table"])
def test_a_run_whose_agent_changes_its_judge_is_not_judged(
    name: str, drive: Callable[..., RunReport]
) -> None:
    change = CHANGES[name]()
    try:
        report = drive(change.do)
    finally:
        change.undo()
    assert report.status is RunStatus.AGENT_FAILED
    assert report.failure is not None
    assert report.failure.cause == "agent_changed_service"
    assert "the agent 'meddler' changed" in report.failure.message
    assert change.said in report.failure.message
    assert not report.verdicts
    assert drive(lambda: None).status is RunStatus.FINISHED


def test_a_feedback_that_changes_its_judge_is_told_from_the_agent(
    drive: Callable[..., RunReport], monkeypatch: pytest.MonkeyPatch
) -> None:
    change = CHANGES["a constant"]()

    class Meddling:
        objectives = ("one",)

        def measure(self, run: RunView) -> Measurement:
            change.do()
            return Measurement(objectives={"one": 1.0})

    monkeypatch.setattr(objective_measuring, "make_feedback", lambda _choice, _laws: Meddling())
    try:
        report = drive(lambda: None, feedback=FeedbackChoice(name="meddling"))
    finally:
        change.undo()
    assert report.status is RunStatus.PLUGIN_FAILED
    assert report.failure is not None
    assert report.failure.cause == "plugin_changed_service"
    assert change.said in report.failure.message
    assert not report.verdicts


def test_an_exception_caused_by_an_agent_is_attributed_to_it(
    drive: Callable[..., RunReport],
) -> None:
    change = replaced(
        trace_assembly, next(iter(functions_of(trace_assembly))), None, "trace_assembly"
    )
    try:
        report = drive(change.do)
    finally:
        change.undo()
    assert report.failure is not None
    assert report.failure.cause == "agent_changed_service"
    assert change.said in report.failure.message


def test_judging_neither_uses_nor_changes_the_global_random_states(
    drive: Callable[..., RunReport],
) -> None:
    first = drive(lambda: None)
    states = random.getstate(), np.random.get_state()[1].tolist()  # type: ignore[index]  # noqa: NPY002 # the state of others
    second = drive(lambda: (random.seed(7), np.random.seed(7)))  # noqa: NPY002 # the state of others
    random.setstate(states[0])
    assert second.verdicts == first.verdicts
    assert second.metrics == first.metrics
    assert second.scores == first.scores
    third = drive(lambda: None, feedback=FeedbackChoice(name="general"))
    assert third.status is RunStatus.FINISHED
    assert random.getstate() == states[0]


def test_the_judging_itself_is_checked_where_other_packages_have_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Guest:
        objectives = ("one",)

        def measure(self, run: RunView) -> Measurement:
            return Measurement(objectives={"one": 1.0})

    start, end = place("harbour_1_0", 20), place("harbour_1_0", 120)
    document = canonical_json(scenario(ego(start, end, agent="idm"), seconds=1.0))
    make: Callable[[FeedbackChoice], Feedback] = measuring.make_feedback
    monkeypatch.setattr(
        objective_measuring,
        "make_feedback",
        lambda c, _laws: Guest() if c.name == "guest" else make(c),
    )
    snapshot_judging_code.cache_clear()
    code = snapshot_judging_code()
    changes, checks = code.changes, [0]

    def counted() -> tuple[str, ...]:
        checks[0] += 1
        return changes()

    monkeypatch.setattr(code, "changes", counted)

    def checked(**more: Any) -> int:
        checks[0] = 0
        spec = RunSpec(run_id="run", document=document, **more)
        assert performing.perform(spec, SETUP).status is RunStatus.FINISHED
        return checks[0]

    assert checked() == 1
    assert checked(feedback=FeedbackChoice(name="behavexplor")) == 2
    assert checked() == 1
    assert checked(feedback=FeedbackChoice(name="guest")) == 2
    # It may have left a thread: the judging of later runs is checked as well.
    assert checked() == 2


def test_a_check_takes_a_small_part_of_a_run(drive: Callable[..., RunReport]) -> None:
    begun = time.process_time()
    drive(lambda: None)
    run = time.process_time() - begun
    code = snapshot_judging_code()
    checks = []
    for _ in range(30):
        begun = time.process_time()
        assert not code.changes()
        checks.append(time.process_time() - begun)
    assert min(checks) < 0.1 * run


def functions_of(module: ModuleType) -> Iterator[str]:
    for name, value in vars(module).items():
        if inspect.isfunction(value) and value.__module__ == module.__name__:
            yield name
