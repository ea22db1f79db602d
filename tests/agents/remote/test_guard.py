"""The process between a worker and an ADS."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from drivora_service.agents.remote import guard
from drivora_service.agents.remote.confinement import Confinement
from drivora_service.agents.remote.guard import BoundedLog


def start(tmp_path: Path, code: str) -> subprocess.Popen[bytes]:
    folder = tmp_path / "folder"
    folder.mkdir()
    return subprocess.Popen(
        [
            sys.executable, "-I", "-S", guard.__file__, str(os.getpid()), str(folder),
            str(tmp_path / "log"), Confinement().text(), sys.executable, "-c", code,
        ]
    )  # fmt: skip


def log(tmp_path: Path) -> str:
    return (tmp_path / "log").read_text()


def wait_for(tmp_path: Path, text: str) -> None:
    limit = time.monotonic() + 60
    while not (tmp_path / "log").exists() or text not in log(tmp_path):
        assert time.monotonic() < limit
        time.sleep(0.02)


@pytest.mark.parametrize(
    ("code", "exit_code", "says"),
    [
        ("print('done')", 0, "done"),
        ("import sys; sys.exit('no')", 1, "no"),
        ("import os; os.kill(os.getpid(), 9)", 137, "[ended by SIGKILL]"),
        ("import os; os.abort()", 134, "[ended by SIGABRT]"),
    ],
)
def test_the_end_of_the_command_is_passed_on(
    tmp_path: Path, code: str, exit_code: int, says: str
) -> None:
    assert start(tmp_path, code).wait(60) == exit_code
    assert says in log(tmp_path)


def test_all_that_was_printed_is_there_at_the_end(tmp_path: Path) -> None:
    guarded = start(tmp_path, "for n in range(50_000): print(n)")
    assert guarded.wait(60) == 0
    assert log(tmp_path).splitlines()[:-1] == [str(n) for n in range(50_000)]


def test_being_told_to_end_ends_all_and_removes_the_folder(tmp_path: Path) -> None:
    code = (
        "import subprocess, sys, time\n"
        "print(subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(3600)']).pid)\n"
        "print('ready', flush=True); time.sleep(3600)"
    )
    guarded = start(tmp_path, code)
    wait_for(tmp_path, "ready")
    grandchild = psutil.Process(int(log(tmp_path).split()[0]))
    guarded.send_signal(signal.SIGTERM)
    guarded.wait(60)
    assert psutil.wait_procs([grandchild], timeout=60)[1] == []
    assert not (tmp_path / "folder").exists()


def test_being_told_to_end_again_and_again_disturbs_nothing(tmp_path: Path) -> None:
    guarded = start(tmp_path, "import time; print('ready', flush=True); time.sleep(3600)")
    for number in range(200):
        (tmp_path / "folder" / str(number)).touch()
    wait_for(tmp_path, "ready")
    for _ in range(1000):
        if guarded.poll() is not None:
            break
        guarded.send_signal(signal.SIGTERM)
    guarded.wait(60)
    assert not (tmp_path / "folder").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="adopting orphans is Linux's")
@pytest.mark.parametrize("told", [True, False], ids=["told to end", "the command ends"])
def test_what_left_the_group_of_the_command_is_ended_too(tmp_path: Path, told: bool) -> None:
    # As launchers and daemons do: a session of its own, and no parent left.
    code = (
        "import subprocess, sys, time\n"
        "sleep = [sys.executable, '-c', 'import time; time.sleep(3600)']\n"
        "start = 'subprocess.Popen({}, start_new_session=True)'.format(sleep)\n"
        "start = 'import subprocess; print({}.pid)'.format(start)\n"
        "subprocess.run([sys.executable, '-c', start])\n"
        f"print('ready', flush=True); time.sleep({3600 if told else 1})"
    )
    guarded = start(tmp_path, code)
    wait_for(tmp_path, "ready")
    daemon = psutil.Process(int(log(tmp_path).split()[0]))
    assert daemon.is_running()
    if told:
        guarded.send_signal(signal.SIGTERM)
    assert guarded.wait(60) == 0
    assert not daemon.is_running()


_TOLD_WHILE_STARTING = """
import json, os, signal, sys, time
from pathlib import Path
from drivora_service.agents.remote import guard
from drivora_service.agents.remote.confinement import Confinement

begin_child = guard._begin_child

def begin(confinement):
    os.kill(os.getppid(), signal.SIGTERM)
    time.sleep(0.2)
    begin_child(confinement)

guard._begin_child = begin
folder, log = Path(sys.argv[2]), guard.BoundedLog(Path(sys.argv[3]))
sleep = [sys.executable, "-c", "import os, time; print(os.getpid(), flush=True); time.sleep(3600)"]
confinement = json.loads(Confinement().text())
sys.exit(guard.main(int(sys.argv[1]), folder, log, confinement, sleep))
"""


def test_being_told_to_end_while_the_command_starts_leaves_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    script = [sys.executable, "-c", _TOLD_WHILE_STARTING, str(os.getpid()), str(folder)]
    done = subprocess.run([*script, str(tmp_path / "log")], timeout=60, check=False)
    assert done.returncode == 0
    assert not folder.exists()


def test_an_orphan_that_holds_the_output_does_not_keep_the_guard(tmp_path: Path) -> None:
    code = (
        "import subprocess, sys\n"
        "subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(3600)'])\n"
        "print('gone', flush=True)"
    )
    assert start(tmp_path, code).wait(60) == 0
    assert "gone" in log(tmp_path)


def test_a_log_keeps_its_newer_half(tmp_path: Path) -> None:
    with contextlib.closing(BoundedLog(tmp_path / "log", limit=1000)) as bounded:
        for number in range(1000):
            bounded.write(f"{number:09}\n".encode())
            assert (tmp_path / "log").stat().st_size <= 1000
    lines = (tmp_path / "log").read_text().splitlines()
    assert len(lines) >= 50
    assert lines == [f"{number:09}" for number in range(1000)][-len(lines) :]


def test_a_single_write_beyond_the_limit_is_cut(tmp_path: Path) -> None:
    with contextlib.closing(BoundedLog(tmp_path / "log", limit=1000)) as bounded:
        bounded.write(b"a" * 5000 + b"the end")
    content = (tmp_path / "log").read_bytes()
    assert len(content) <= 1000
    assert content.endswith(b"the end")
