"""Small languages of the command line: gates and parameters of agents."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from drivora_service.cli.runs.run_gates import read_gate
from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.scenario.agent_parameters import read_agent_parameter, with_agent_parameters
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import validate_data
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.fuzzing.parsers.shared import agents, networks
from tests.scenario.conftest import GOOD


def _parse_gate(data: bytes) -> bool:
    wanted = data.decode("utf-8", "surrogateescape").split("\n")
    try:
        gate = read_gate(wanted, _oracles(), counted_by="Drivora")
    except ConfigurationError as error:
        check_refusal(error)
        return False
    assert all(count >= 0 for count in gate.allowed.values())
    return True


@cache
def _oracles() -> tuple[str, ...]:
    return tuple(OracleCatalogue().names())


@cache
def _scenario() -> Scenario:
    return validate_data(GOOD, networks(), None).scenario


def _parse_parameter(data: bytes) -> bool:
    words = data.decode("utf-8", "surrogateescape").split("\n")
    try:
        parameters = [read_agent_parameter(word) for word in words]
        with_agent_parameters(_scenario(), parameters, agents().availability())
    except InvalidDocument as error:
        check_refusal(error)
        return False
    return True


def _gate_seeds() -> Mapping[str, bytes]:
    return {"one": b"collision=0", "two": b"red_light\nspeeding=12"}


def _parameter_seeds() -> Mapping[str, bytes]:
    return {
        "number": b"speed_factor=1.2",
        "of-one": b"ego_0:speed_factor=0.5\nspeed_factor=1",
        "list": b'ego_0:speed_factor=[1, {"a": null}, true]\nego_0:speed_factor=1e-1',
    }


GATE = Harness(name="gate-oracle", parse=_parse_gate, seeds=_gate_seeds)
AGENT_PARAMETER = Harness(
    name="agent-parameter", parse=_parse_parameter, seeds=_parameter_seeds, max_length=8192
)
HARNESSES = by_name(GATE, AGENT_PARAMETER)
