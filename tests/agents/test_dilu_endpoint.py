"""DiLu with a language model behind a real HTTP endpoint: driving, and each way to fail."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.agents.adapters.dilu import adapter as dilu_adapter
from drivora_service.agents.adapters.dilu.adapter import DiluAdapter
from drivora_service.agents.adapters.dilu.decisions import DECISIONS, Decision
from drivora_service.agents.adapters.dilu.endpoint import EndpointModel
from drivora_service.agents.adapters.dilu.experiences import Memory, read_experiences
from drivora_service.agents.adapters.dilu.models import ModelError
from drivora_service.agents.adapters.dilu.operator_settings import EndpointSettings
from drivora_service.agents.adapters.dilu.prompts import Message
from drivora_service.agents.adapters.dilu.reasoning import Driver
from drivora_service.agents.adapters.dilu.situation import Beside, Situation
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent, AgentContext, Control, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.agents.remote.adapter_messages import context_view, observation_view
from drivora_service.agents.remote.remote_messages import setup_request, step_request
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import NpcObstacle
from drivora_service.settings import load_settings
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.chat_server import Answer, ChatServer, chat_server
from tests.agents.remote.folders import add_agent
from tests.simulation.episodes import ego, obstacle, place, row_of, run, scenario

KEY = "sk-secret"
SLOW = re.compile(r"at (\d+\.\d) m/s and want (\d+\.\d) m/s; allowed are (\d+\.\d)")


def careful(chat: list[dict[str, str]]) -> str:
    """Says what a good driver would to a situation."""
    told = chat[-1]["content"]
    found = SLOW.search(told)
    assert found is not None, told
    wanted, allowed = float(found[2]), float(found[3])
    word = "accelerate" if wanted < allowed - 0.05 else "keep"
    if re.search(r"in your lane: .*\(slower\)", told) and "to the left: ahead nobody" in told:
        word = "left"
    return f"I look at it.\nResponse to user:#### {word}"


def always(text: str) -> Answer:
    return lambda chat: text


@pytest.fixture
def chat() -> Iterator[ChatServer]:
    with chat_server(careful) as server:
        yield server


def model(chat: ChatServer, key: str = KEY) -> EndpointModel:
    return EndpointModel(EndpointSettings(url=chat.url, model="wise", api_key=key))


class Here:
    """An adapter in this process, behind the protocol's messages."""

    def __init__(self, adapter: DiluAdapter) -> None:
        self.adapter = adapter

    def setup_env(self, context: AgentContext) -> None:
        self.adapter.setup_env(context_view(setup_request(context, "run"), context.log))

    def run_step(self, observation: Observation) -> Control:
        return self.adapter.run_step(observation_view(step_request(observation, "run")))


def drive(
    chat: ChatServer, *boxes: NpcObstacle, seconds: float = 60.0, end: float = 120.0
) -> Trace:
    route = place("harbour_1_0", 20), place("harbour_1_0", end)
    what = scenario(ego(*route), seconds=seconds, npc_obstacles=boxes)
    return run(what, Here(DiluAdapter(model(chat), 30.0)))


def events(trace: Trace, begin: str) -> list[str]:
    return [e.message[len(begin) :] for e in trace.log_events if e.message.startswith(begin)]


def column(trace: Trace, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return trace.log_values[:-1, 0, trace.log_names.index(name)]


def test_it_asks_once_a_second_and_arrives(chat: ChatServer) -> None:
    trace = drive(chat)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert len(chat.requests) == len(events(trace, "decision: ")) == int(trace.times[-2]) + 1
    assert set(chat.keys) == {f"Bearer {KEY}"}
    body = chat.requests[0]
    assert (body["model"], body["temperature"]) == ("wise", 0)
    roles = [message["role"] for message in body["messages"]]
    assert roles == ["system", *["user", "assistant"] * 3, "user"]
    assert np.diff(column(trace, "decisions")).max() == 1.0
    assert column(trace, "unclear")[-1] == 0.0


def test_the_log_tells_prompts_memory_and_decisions(chat: ChatServer) -> None:
    trace = drive(chat, seconds=3.0)
    assert events(trace, "model: ") == [f"wise at {chat.url}"]
    assert "Response to user" in events(trace, "system message: ")[0]
    assert len(events(trace, "experience ")) == 26
    asked = [body["messages"][-1]["content"] for body in chat.requests]
    assert events(trace, "situation: ") == asked
    assert asked[0].endswith("Available now: keep, accelerate.")
    assert len(events(trace, "examples: ")) == len(events(trace, "answer: ")) == 3
    assert KEY not in "".join(e.message for e in trace.log_events)


@pytest.mark.parametrize(
    ("text", "asked", "unparsed"), [("#### accelerate", 1, 0), ("I am not sure.", 2, 1)]
)
def test_an_answer_without_a_decision_is_asked_for_again_and_then_keeps(
    chat: ChatServer, text: str, asked: int, unparsed: int
) -> None:
    chat.answer = always(text)
    trace = drive(chat, seconds=3.0)
    assert len(chat.requests) == 3 * asked
    assert column(trace, "unclear")[-1] == column(trace, "unparsed")[-1] == 3 * unparsed
    assert len(events(trace, "no decision again: keep")) == 3 * unparsed
    moved = np.nanmax(trace.speeds(row_of(trace, "ego")))
    assert (moved < 0.1) == bool(unparsed)


def test_the_decision_can_come_with_the_second_answer(chat: ChatServer) -> None:
    chat.answer = lambda said: "#### accelerate" if len(said) == 1 else "Off we go!"
    trace = drive(chat, seconds=2.0)
    assert (column(trace, "unclear")[-1], column(trace, "unparsed")[-1]) == (2.0, 0.0)
    assert set(events(trace, "decision: ")) == {"accelerate"}


def test_what_is_not_available_is_kept_from_and_counted(chat: ChatServer) -> None:
    chat.answer = always("#### left")
    trace = drive(chat, seconds=2.0)
    assert set(events(trace, "decision: ")) == {"keep"}
    assert column(trace, "impossible")[-1] == 2.0
    assert not column(trace, "lane").any()


def test_it_stops_behind_who_stands_whatever_is_said(chat: ChatServer) -> None:
    chat.answer = always("#### accelerate")
    trace = drive(chat, obstacle(place("harbour_1_0", 75.0)), seconds=20.0)
    assert not trace.contacts
    assert trace.speeds(row_of(trace, "ego"))[-2] < 0.2


def driver(chat: ChatServer) -> Driver:
    memory = Memory(read_experiences())
    return Driver(model=model(chat), memory=memory, examples=2, log=AgentLog())


ODD = Situation(
    speed=9.0, wanted=9.0, allowed=20.0, left=Beside(), right=Beside(), stop=20.0, crossing=4.0
)


def test_a_mistake_is_reflected_upon_and_shown_from_then_on(chat: ChatServer) -> None:
    learner, until = driver(chat), time.monotonic() + 60.0
    chat.answer = always("Hurry.\n#### accelerate")
    assert learner.decide(ODD, until) is Decision.ACCELERATE
    chat.answer = always("Somebody crosses.\n#### decelerate")
    learner.reflect(5.0, until)
    told = chat.requests[-1]["messages"]
    assert told[2]["content"] == "Hurry.\n#### accelerate"
    assert "accelerate was wrong" in told[3]["content"]
    assert (learner.counts.reflections, learner.counts.corrected) == (1, 1)
    learnt = learner.memory.experiences[-1]
    assert (learnt.situation, learnt.decision) == (ODD, Decision.DECELERATE)
    assert learnt.why == "I made a mistake here before: Somebody crosses."
    learner.decide(ODD, until)
    assert learnt.why in chat.requests[-1]["messages"][-2]["content"]
    assert len(driver(chat).memory.experiences) == 26


def test_a_reflection_that_corrects_nothing_is_not_kept(chat: ChatServer) -> None:
    learner, until = driver(chat), time.monotonic() + 60.0
    learner.reflect(5.0, until)
    assert (chat.requests, learner.counts.reflections) == ([], 0)
    chat.answer = always("#### keep")
    learner.decide(ODD, until)
    learner.reflect(5.0, until)
    assert (learner.counts.reflections, learner.counts.corrected) == (1, 0)
    assert len(learner.memory.experiences) == 26


@pytest.mark.parametrize(
    ("speed", "trouble", "gained"), [(9.0, False, 1), (0.0, False, 0), (9.0, True, 0)]
)
def test_what_went_well_is_kept_if_it_is_new(
    chat: ChatServer, speed: float, trouble: bool, gained: int
) -> None:
    chat.answer = always("So be it.\n#### keep")
    learner, until = driver(chat), time.monotonic() + 60.0
    for number in range(12):
        learner.decide(replace(ODD, speed=speed), until)
        if trouble and number % 3 == 0:
            learner.reflect(5.0, until)
    # The second one would be like the first.
    assert learner.counts.gained == gained
    assert len(learner.memory.experiences) == 26 + gained


@pytest.mark.parametrize(
    ("status", "body", "says"),
    [
        (500, f"out of memory for {KEY}", "answered 500 with 'out of memory for"),
        (401, "who are you", "DRIVORA_DILU_API_KEY is right"),
        (200, "<html>hello</html>", "no chat completion"),
        (200, '{"choices": []}', "no chat completion"),
        (200, '{"choices": [{"message": {"content": null}}]}', "no chat completion"),
        (200, "[1]", "no chat completion"),
    ],
)
def test_an_endpoint_that_fails_is_told_of(
    chat: ChatServer, status: int, body: str, says: str
) -> None:
    chat.failing = lambda: (status, body)
    with pytest.raises(ModelError) as failure:
        model(chat).answer([Message(role="user", content="x")], DECISIONS, 5.0)
    assert says in str(failure.value)
    assert KEY not in str(failure.value)


def test_a_slow_endpoint_is_not_waited_for(chat: ChatServer) -> None:
    chat.failing = lambda: (time.sleep(1.0), (200, "late"))[1]  # type: ignore[func-returns-value]  # sleep, in a lambda
    with pytest.raises(ModelError, match=r"within 0\.2 s .*DRIVORA_DILU_TIMEOUT_S"):
        model(chat).answer([Message(role="user", content="x")], DECISIONS, 0.2)


Failing = Callable[[], tuple[int, str]]


def test_a_process_with_an_endpoint_drives_and_fails_with_its_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, chat: ChatServer
) -> None:
    """As the service runs it, but for the environment: this one's has what the endpoint needs."""
    names = ["DRIVORA_DILU_ENDPOINT", "DRIVORA_DILU_MODEL", "DRIVORA_DILU_API_KEY"]
    command = ["{python}", dilu_adapter.__file__]
    add_agent(tmp_path, "dilu-here", command=command, settings=names)
    for name, value in zip(names, (chat.url, "wise", KEY), strict=True):
        monkeypatch.setenv(name, value)
    catalogue = AgentCatalogue(folder=tmp_path)

    def attempt() -> Trace:
        catalogue.begin_run()
        agent = catalogue.create("dilu-here", {})
        assert not isinstance(agent, SumoDriver)
        return run(scenario(ego(*ROUTE), seconds=2.5), agent)

    try:
        one, two = attempt(), attempt()
        assert set(chat.keys) == {f"Bearer {KEY}"}
        assert trace_sha256(one) == trace_sha256(two)
        chat.failing = lambda: (503, "overloaded")
        with pytest.raises(AgentError, match="answered 503 with 'overloaded'") as failure:
            attempt()
        assert failure.value.cause == "agent_raised"
        assert "Traceback" in failure.value.log
        chat.failing = None
        assert trace_sha256(attempt()) == trace_sha256(one)
        chat.server.server_close()
        with pytest.raises(AgentError, match="cannot be reached") as failure:
            attempt()
        assert KEY not in str(failure.value) + failure.value.log
    finally:
        catalogue.close()


class TestContract(AgentContract):
    @pytest.fixture(autouse=True)
    def _endpoint(self, chat: ChatServer) -> None:
        chat.answer = always("#### accelerate")
        self.chat = chat

    def make_agent(self) -> Agent:
        return Here(DiluAdapter(model(self.chat), 30.0))


ROUTE = place("harbour_1_0", 20), place("harbour_1_0", 120)


@pytest.mark.slow
def test_the_embedded_model_decides_and_the_same_again() -> None:
    if any(name.startswith("DRIVORA_DILU_") for name in os.environ):
        pytest.skip("an endpoint is set")
    catalogue = AgentCatalogue(folder=load_settings().agents_folder, longest_call_s=120.0)
    if not catalogue.entry("dilu").installed:
        pytest.skip("dilu is not installed: run `drivora agents install dilu`")
    traces = []
    try:
        for _ in range(2):
            catalogue.begin_run()
            agent = catalogue.create("dilu", {})
            assert not isinstance(agent, SumoDriver)
            traces.append(run(scenario(ego(*ROUTE), seconds=4.0), agent))
    finally:
        catalogue.close()
    assert trace_sha256(traces[0]) == trace_sha256(traces[1])
    assert len(events(traces[0], "decision: ")) == 4
    assert column(traces[0], "unclear")[-1] == 0.0
