"""A Ray cluster whose head ends and is started again, and machines that may not connect."""

from __future__ import annotations

import contextlib
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from unittest import mock

import psutil
import pytest

from drivora_service.execution.ray import ray_connection
from drivora_service.execution.ray.preconditions import explain
from drivora_service.execution.ray.ray_executor import RayExecutor
from drivora_service.runs.run_report import RunSpec, RunStatus
from tests.execution.attempts import LIMITS, TASKS, pid_of, run, wait_for
from tests.execution.ray_cluster import SILENCE_S, kill_node, supervised_node, until

_LONG_S = 300.0
_ALONE = ("unshare", "--user", "--map-root-user", "--pid", "--fork", "--mount-proc")
"""Runs a command on what is a machine of its own to Ray, which looks for a node's processes."""
_TOKEN = {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": "5e1f" * 16}
"""What all processes of a cluster with a token have."""

_FAULT = """
import sys, time
from pathlib import Path
from drivora_service.execution.ray.ray_executor import RayExecutor
with RayExecutor(address=sys.argv[1], setup="", folder=Path(sys.argv[2])) as executor:
    while not (fault := executor.fault):
        time.sleep(0.05)
    # In one piece, as another thread writes its log at the same time.
    sys.stdout.write(f"\\nfault: {fault}\\n")
"""


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder for Ray, whose sockets have short paths."""
    with tempfile.TemporaryDirectory(prefix="ray-", ignore_cleanup_errors=True) as path:
        yield Path(path)


@pytest.fixture
def token(monkeypatch: pytest.MonkeyPatch) -> None:
    """Has all that the test starts use a token."""
    for name, value in _TOKEN.items():
        monkeypatch.setenv(name, value)


@pytest.fixture
def address() -> str:
    return free_address()


def free_address() -> str:
    """Returns an address at which nothing listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"127.0.0.1:{probe.getsockname()[1]}"


def head(address: str) -> tuple[str, ...]:
    return (
        "--head",
        f"--port={address.rpartition(':')[2]}",
        "--num-cpus=0",
        "--include-dashboard=false",
    )


def answers(address: str) -> bool:
    """Tells whether something listens at an address."""
    host, _, port = address.rpartition(":")
    with socket.socket() as probe:
        return probe.connect_ex((host, int(port))) == 0


def raylets(*supervisors: psutil.Process) -> list[psutil.Process]:
    """Returns the process of each node that runs."""
    found = []
    for supervisor in supervisors:
        for one in supervisor.children(recursive=True):
            with contextlib.suppress(psutil.NoSuchProcess):
                if one.name() == "raylet":
                    found.append(one)
    return found


def fault_of(address: str, folder: Path, *before: str, **environment: str) -> str:
    """Returns what a command says that cannot use a cluster that answers."""
    command = [*before, sys.executable, "-c", _FAULT, address, str(folder)]
    inherited = {name: value for name, value in os.environ.items() if name not in _TOKEN}
    deadline = time.monotonic() + _LONG_S
    while True:
        done = subprocess.run(
            command,
            env={**inherited, **environment},
            capture_output=True,
            text=True,
            check=True,
            timeout=_LONG_S,
        )
        fault: str
        (fault,) = re.findall("^fault: (.+)$", done.stdout, re.MULTILINE)
        if "refused" not in fault:
            return fault
        # The head is starting.
        assert time.monotonic() < deadline


def runs(process: psutil.Process) -> bool:
    """Tells whether a process has not ended."""
    with contextlib.suppress(psutil.NoSuchProcess):
        return process.status() != psutil.STATUS_ZOMBIE
    return False


@pytest.mark.slow(seconds=60)
@pytest.mark.usefixtures("token")
def test_runs_are_performed_again_after_the_head_was_started_again(
    address: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ray_connection, "_SILENCE_S", SILENCE_S)

    def node(*options: str) -> psutil.Process:
        return parts.enter_context(supervised_node(*options, folder=folder))

    with ExitStack() as parts:
        first = node(*head(address))
        until(lambda: answers(address), within_s=_LONG_S)
        # The one of the machine of the executor, and one that performs runs.
        others = [node(f"--address={address}", f"--num-cpus={cpus}") for cpus in (0, 1)]
        executor = parts.enter_context(
            RayExecutor(
                address=address,
                setup="",
                folder=tmp_path,
                # The run that is lost does not end before the cluster does.
                limits=replace(LIMITS, wall_time_s=_LONG_S),
                perform=TASKS,
                warm_up="",
            )
        )
        until(lambda: executor.slots() and len(raylets(*others)) == 2, within_s=_LONG_S)
        before = {slot.name for slot in executor.slots()}
        old = raylets(*others)
        assert run(executor, "sleep 0").report.status is RunStatus.FINISHED
        executor.submit(RunSpec(run_id="lost", document="hangs"))
        pid_of(executor, "lost")

        kill_node(first)
        until(lambda: executor.fault, within_s=_LONG_S)
        (end,) = wait_for(executor, 1)
        assert end.report.status is RunStatus.INFRASTRUCTURE_FAILED
        executor.submit(RunSpec(run_id="waiting", document="sleep 0"))

        # The other nodes end, as nodes of a cluster that is gone; on one machine, the head is not
        # started again before they have. Then all are nodes of a new one, at the same address.
        until(lambda: not any(map(runs, old)), within_s=_LONG_S)
        until(executor.slots, within_s=_LONG_S)
        (end,) = wait_for(executor, 1)
        assert (end.report.run_id, end.report.status) == ("waiting", RunStatus.FINISHED)
        assert executor.fault == ""
        assert before.isdisjoint(slot.name for slot in executor.slots())
        until(lambda: len(raylets(*others)) == 2, within_s=_LONG_S)


@pytest.fixture(scope="module")
def guarded() -> Iterator[str]:
    """The address of a head that only processes with a token can use."""
    address = free_address()
    with (
        tempfile.TemporaryDirectory(prefix="ray-", ignore_cleanup_errors=True) as path,
        mock.patch.dict(os.environ, _TOKEN),
        supervised_node(*head(address), folder=Path(path)),
    ):
        yield address


@pytest.mark.slow(seconds=15)
def test_a_machine_that_is_no_node_is_told_to_become_one(guarded: str, tmp_path: Path) -> None:
    if subprocess.run([*_ALONE, "true"], capture_output=True, check=False).returncode:
        pytest.skip("this system gives no namespace of processes")
    assert fault_of(guarded, tmp_path, *_ALONE, **_TOKEN) == (
        f"the Ray cluster at {guarded} answers, but this machine is no node of it: run "
        f"`ray start --address={guarded} --num-cpus=0` here"
    )


@pytest.mark.slow(seconds=15)
def test_a_process_without_the_token_of_a_cluster_cannot_use_it(
    guarded: str, tmp_path: Path
) -> None:
    wrong = {**_TOKEN, "RAY_AUTH_TOKEN": "0bad" * 16}
    # Nor is there one in a file that Ray looks at.
    none = {"RAY_AUTH_MODE": "token", "HOME": str(tmp_path)}
    for environment in ({}, wrong, none):
        assert fault_of(guarded, tmp_path, **environment) == (
            f"the Ray cluster at {guarded} cannot be used: its token is missing or wrong; set "
            "RAY_AUTH_MODE=token and the same RAY_AUTH_TOKEN as on its nodes"
        )


def test_what_ray_does_not_explain_names_both_causes() -> None:
    error = ConnectionError("Failed to connect to Ray cluster at here:1")
    reason = explain(error, "here:1", is_reached=True).reason
    assert "Failed to connect" in reason
    assert "`ray start --address=here:1 --num-cpus=0`" in reason
    # Ray itself has it in the cause of its error.
    error.__cause__ = RuntimeError("No node info found matching attributes: ''")
    for is_reached in (True, False):
        assert (
            "this machine is no node of it" in explain(error, "auto", is_reached=is_reached).reason
        )
    unknown = explain(ConnectionError("Failed to connect"), "auto", is_reached=False).reason
    assert unknown.endswith("; start it, correct DRIVORA_RAY_ADDRESS, or set its RAY_AUTH_TOKEN")
    refused = explain(ConnectionRefusedError("refused"), "here:1", is_reached=False).reason
    assert refused == "cannot be reached: refused; start it, or correct DRIVORA_RAY_ADDRESS"
