from __future__ import annotations

from drivora_service.execution.executor import Limits
from drivora_service.execution.watch import Breach, Watch
from drivora_service.runs.progress import Progress
from drivora_service.runs.report import RunStatus
from drivora_service.simulation.phase import SETTING_UP, Phase

LIMITS = Limits(wall_time_s=100.0, agent_deadline_s=5.0, memory_bytes=1000)


def reading(phase: Phase, *, step: int = 0, ego: int = 0) -> Progress:
    return Progress(phase=phase, step=step, ego=ego, run_counter=1)


def outcome(breach: Breach | None) -> tuple[RunStatus, str] | None:
    return None if breach is None else (breach.status, breach.failure.cause)


def test_an_agent_may_take_its_time_again_at_each_call() -> None:
    watch = Watch(LIMITS, now=0.0)
    for call in range(10):
        now = 4.0 * call
        assert (
            watch.check(reading(Phase.IN_AGENT, step=call // 2, ego=call % 2), 0, now=now) is None
        )
    late = reading(Phase.IN_AGENT, step=4, ego=1)
    assert watch.check(late, 0, now=40.9) is None
    assert outcome(watch.check(late, 0, now=41.1)) == (RunStatus.AGENT_FAILED, "agent_hung")


def test_setting_up_and_the_first_step_have_deadlines_of_their_own() -> None:
    watch = Watch(LIMITS, now=0.0)
    assert watch.check(reading(Phase.IN_AGENT, step=SETTING_UP), 0, now=0.0) is None
    assert watch.check(reading(Phase.IN_AGENT, step=SETTING_UP), 0, now=4.9) is None
    # No reading fell into the moment between the two calls.
    assert watch.check(reading(Phase.IN_AGENT, step=0), 0, now=5.0) is None
    assert watch.check(reading(Phase.IN_AGENT, step=0), 0, now=9.9) is None
    late = watch.check(reading(Phase.IN_AGENT, step=0), 0, now=10.1)
    assert late is not None
    assert "from step 0 within 5 s" in late.failure.message
    watch = Watch(LIMITS, now=0.0)
    assert watch.check(reading(Phase.IN_AGENT, step=SETTING_UP), 0, now=0.0) is None
    late = watch.check(reading(Phase.IN_AGENT, step=SETTING_UP), 0, now=5.1)
    assert late is not None
    assert "from setup_env within 5 s" in late.failure.message


def test_only_agents_have_a_deadline() -> None:
    watch = Watch(LIMITS, now=0.0)
    for phase in (Phase.PREPARING, Phase.SIMULATING, Phase.JUDGING):
        assert watch.check(reading(phase), 0, now=1.0) is None
        assert watch.check(reading(phase), 0, now=99.0) is None
    late = watch.check(reading(Phase.SIMULATING, step=7), 0, now=100.1)
    assert outcome(late) == (RunStatus.TIMED_OUT, "wall_time_limit")
    assert late is not None
    assert "simulating step 7" in late.failure.message


def test_memory_is_laid_to_whoever_was_seen_growing() -> None:
    watch = Watch(LIMITS, now=0.0)
    assert watch.check(reading(Phase.IN_AGENT), 1000, now=1.0) is None
    agent = watch.check(reading(Phase.IN_AGENT), 1001, now=1.0)
    simulator = watch.check(reading(Phase.SIMULATING), 1001, now=1.0)
    assert outcome(agent) == (RunStatus.AGENT_FAILED, "memory_limit")
    assert outcome(simulator) == (RunStatus.SIMULATOR_CRASHED, "memory_limit")
