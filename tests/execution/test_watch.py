from __future__ import annotations

from drivora_service.execution.executor import Limits
from drivora_service.execution.watch import Breach, Sample, Watch
from drivora_service.runs.run_report import RunStatus
from drivora_service.simulation.run_phase import SETTING_UP, RunPhase
from drivora_service.worker.process_readings import ProcessReading
from drivora_service.worker.progress_board import Progress

LIMITS = Limits(wall_time_s=100.0, agent_deadline_s=5.0, memory_bytes=1000)


def reading(phase: RunPhase, *, step: int = 0, ego: int = 0) -> Progress:
    return Progress(phase=phase, step=step, ego=ego, run_counter=1)


def outcome(breach: Breach | None) -> tuple[RunStatus, str] | None:
    return None if breach is None else (breach.status, breach.failure.cause)


class Worker:
    """A worker that is sampled five times a second."""

    def __init__(self) -> None:
        self.watch = Watch(LIMITS, now=0.0)
        self.now = self.cpu_s = 0.0

    def look(
        self, progress: Progress, *, state: str = "S", memory: int = 0, descendants: int = 0
    ) -> Breach | None:
        process = ProcessReading(
            state=state, cpu_s=self.cpu_s, memory_bytes=memory, started=1.0, name="python"
        )
        sample = Sample(
            progress=progress, process=process, descendant_memory=descendants, now=self.now
        )
        return self.watch.check(sample)

    def live(
        self,
        seconds: float,
        progress: Progress,
        *,
        state: str = "S",
        share: float = 0.0,
        every: float = 0.2,
    ) -> Breach | None:
        """Lets time pass, of which the worker has a share of the processor."""
        for _ in range(round(seconds / every)):
            self.now += every
            self.cpu_s += share * every
            breach = self.look(progress, state=state)
            if breach is not None:
                return breach
        return None


def test_an_agent_may_take_its_time_again_at_each_call() -> None:
    worker = Worker()
    for call in range(10):
        progress = reading(RunPhase.IN_AGENT, step=call // 2, ego=call % 2)
        assert worker.live(4.0, progress) is None
    late = reading(RunPhase.IN_AGENT, step=7, ego=1)
    assert worker.live(5.0, late) is None
    assert outcome(worker.live(0.6, late)) == (RunStatus.AGENT_FAILED, "agent_hung")


def test_setting_up_and_the_first_step_have_deadlines_of_their_own() -> None:
    worker = Worker()
    assert worker.live(4.8, reading(RunPhase.IN_AGENT, step=SETTING_UP)) is None
    # No reading fell into the moment between the two calls.
    assert worker.live(4.8, reading(RunPhase.IN_AGENT, step=0)) is None
    late = worker.live(1.0, reading(RunPhase.IN_AGENT, step=0))
    assert late is not None
    assert "from step 0 within 5 s" in late.failure.message
    late = Worker().live(6.0, reading(RunPhase.IN_AGENT, step=SETTING_UP))
    assert late is not None
    assert "from setup_env within 5 s" in late.failure.message


def test_only_agents_have_a_deadline() -> None:
    worker = Worker()
    for phase in (RunPhase.PREPARING, RunPhase.SIMULATING, RunPhase.JUDGING):
        assert worker.live(33.0, reading(phase)) is None
    late = worker.live(2.0, reading(RunPhase.SIMULATING, step=7))
    assert outcome(late) == (RunStatus.TIMED_OUT, "wall_time_limit")
    assert late is not None
    assert "simulating step 7" in late.failure.message


def test_an_agent_that_computes_is_charged_its_processor_time() -> None:
    spins = reading(RunPhase.IN_AGENT, step=3)
    assert outcome(Worker().live(6.0, spins, state="R", share=1.0)) == (
        RunStatus.AGENT_FAILED,
        "agent_hung",
    )
    # Four threads of it do not make the time pass four times as fast.
    assert Worker().live(4.6, spins, state="R", share=4.0) is None


def test_time_that_the_worker_did_not_have_is_not_attributed_to_the_agent() -> None:
    call = reading(RunPhase.IN_AGENT, step=3)
    for state, share in (("T", 0.0), ("D", 0.0), ("R", 0.02)):
        worker = Worker()
        assert worker.live(60.0, call, state=state, share=share) is None
        assert outcome(worker.live(60.0, call, state=state, share=share)) == (
            RunStatus.INFRASTRUCTURE_FAILED,
            "worker_stopped",
        )


def test_a_delayed_server_attributes_no_time_to_workers() -> None:
    worker = Worker()
    call = reading(RunPhase.IN_AGENT, step=3)
    assert worker.live(600.0, call, every=200.0) is None
    assert worker.live(1.0, call) is None
    assert outcome(worker.live(2.0, call)) == (RunStatus.AGENT_FAILED, "agent_hung")


def test_memory_is_attributed_to_the_agent_in_whose_call_it_was_seen() -> None:
    worker = Worker()
    assert worker.look(reading(RunPhase.IN_AGENT), memory=1000) is None
    agent = worker.look(reading(RunPhase.IN_AGENT), memory=1001)
    simulator = worker.look(reading(RunPhase.SIMULATING), memory=1001)
    assert outcome(agent) == (RunStatus.AGENT_FAILED, "memory_limit")
    assert outcome(simulator) == (RunStatus.SIMULATOR_CRASHED, "memory_limit")


def test_only_agents_start_processes() -> None:
    worker = Worker()
    assert worker.look(reading(RunPhase.SIMULATING), memory=500, descendants=500) is None
    breach = worker.look(reading(RunPhase.SIMULATING), memory=500, descendants=501)
    assert outcome(breach) == (RunStatus.AGENT_FAILED, "memory_limit")
