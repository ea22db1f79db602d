#!/usr/bin/env python3
"""Tries an image: tokens, time until it is ready, a batch that is judged, its size, its shutdown.

Needs buildah (with containers in chroots, so that neither a daemon nor namespaces are needed) or
docker, and no package. DRIVORA_DATABASE_URL has the service use a database of PostgreSQL; with
``--ray``, a node of Ray in the container performs the runs::

    deploy/image/smoke.py [--image drivora] [--most-mb 900] [--volume FOLDER:FOLDER] [--ray]
"""

from __future__ import annotations

import argparse
import json
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

_EXAMPLES = Path(__file__).resolve().parents[2] / "openscenario_schemas" / "examples"
_SCENARIOS = ("walker-behind-van", "wet-arterial")
_KERNELS = "find /home/drivora/.cache/numba -name '*.nbc' | sort"
_ORPHAN = """
import os, time
read, write = os.pipe()
if os.fork() == 0:
    if os.fork() == 0:
        os.write(write, str(os.getpid()).encode())
        time.sleep(0.5)
    os._exit(0)
os.wait()
orphan = os.read(read, 20).decode()
until = time.monotonic() + 20.0
while os.path.exists(f"/proc/{orphan}") and time.monotonic() < until:
    time.sleep(0.1)
print("left" if os.path.exists(f"/proc/{orphan}") else "reaped")
"""
"""A program of Python that tells what became of a process that lost its parent and ended."""
_SERVE = ("drivora", "serve")
_SERVE_BESIDE_RAY = """
(ray start --head --port={port} --num-cpus=2 --object-store-memory=209715200 \\
  --include-dashboard=false --block > /tmp/ray.log 2>&1 &)
until ray health-check --address=127.0.0.1:{port} > /dev/null 2>&1; do sleep 1; done
exec drivora serve
"""
"""A program of the shell; see ``compose/ray.yaml``."""
_READY_S = 300.0
_RUNS_S = 300.0
_STOP_S = 90.0


class Failed(Exception):
    """The image does not do what it should."""


class Buildah:
    """A container of buildah; its processes run in a chroot, with the network of the host."""

    def __init__(self, image: str, volumes: list[str]) -> None:
        self.image = image
        self._options = [f"--volume={volume}" for volume in volumes]
        self._container = _output("buildah", "from", image)
        config = json.loads(_output("buildah", "inspect", "--type", "image", image))
        self._entrypoint = config["Docker"]["config"]["Entrypoint"]

    def size_mb(self) -> float:
        """Returns the size of the image as its layers are on the disk."""
        mounted = Path(_output("buildah", "mount", self._container))
        printed = _output("du", "--summarize", "--bytes", "--one-file-system", str(mounted))
        return int(printed.split()[0]) / 1e6

    def run(self, *command: str, **variables: str) -> str:
        """Runs a command that ends, and returns what it printed."""
        return _output(*self._command(variables), *command)

    def drivora(self, *arguments: str) -> str:
        """Runs the program of the image."""
        return self.run(*self._entrypoint, *arguments)

    def python(self, program: str) -> str:
        """Runs a program of Python in place of the service, below the init of the image."""
        return self.run(*self._entrypoint[:-1], "python", "-c", program)

    @contextmanager
    def serving(self, port: int, log: Path, *service: str, **variables: str) -> Iterator[None]:
        """Runs the service below the init; ends it as a stop of the container does."""
        command = self._command({**variables, "DRIVORA_PORT": str(port)})
        with log.open("w") as target:
            process = subprocess.Popen(
                [*command, *self._entrypoint[:-1], *service],
                stdout=target,
                stderr=subprocess.STDOUT,
            )
        try:
            yield
        finally:
            # Only to the init of the container, which tells the service.
            below = _descendants(process.pid)
            inits = [pid for pid in below if _name_of(pid) == self._entrypoint[0]]
            started = _opened(child for pid in inits for child in _descendants(pid))
            for pid in inits:
                os.kill(pid, signal.SIGTERM)
            _wait_until_ended(inits)
            # In a chroot, the end of the init ends no other process.
            for process_file in started:
                with suppress(ProcessLookupError):
                    signal.pidfd_send_signal(process_file, signal.SIGKILL)
                os.close(process_file)
            code = _wait(process)
        if code:
            raise Failed(f"the service ended with {code}")

    def remove(self) -> None:
        """Removes the container."""
        _output("buildah", "rm", self._container)

    def _command(self, variables: dict[str, str]) -> list[str]:
        given = [f"--env={name}={value}" for name, value in variables.items()]
        isolation = f"--isolation={os.environ.get('BUILDAH_ISOLATION', 'chroot')}"
        return ["buildah", "run", isolation, *self._options, *given, self._container, "--"]


class Docker:
    """A volume of docker and the containers on it."""

    def __init__(self, image: str, volumes: list[str]) -> None:
        self.image = image
        self._volume = _output("docker", "volume", "create")
        self._options = [f"--volume={volume}" for volume in (f"{self._volume}:/data", *volumes)]
        self._service = ""

    def size_mb(self) -> float:
        """Returns the size of the image as its layers are on the disk."""
        printed = _output("docker", "image", "inspect", "--format", "{{.Size}}", self.image)
        return int(printed) / 1e6

    def run(self, *command: str, **variables: str) -> str:
        """Runs a command in the running service's container, or in a new one."""
        if self._service:
            return _output("docker", "exec", self._service, *command)
        given = [f"--env={name}={value}" for name, value in variables.items()]
        program, *arguments = command
        return _output(
            *("docker", "run", "--rm", *self._options, *given, f"--entrypoint={program}"),
            *(self.image, *arguments),
        )

    def drivora(self, *arguments: str) -> str:
        """Runs the program of the image."""
        return _output("docker", "run", "--rm", *self._options, self.image, *arguments)

    def python(self, program: str) -> str:
        """Runs a program of Python in place of the service, below the init of the image."""
        return self.run(*self._init(), "python", "-c", program)

    @contextmanager
    def serving(self, port: int, log: Path, *service: str, **variables: str) -> Iterator[None]:
        """Runs the service below the init; ends it as a stop of the container does."""
        given = [f"--env={name}={value}" for name, value in variables.items()]
        init, *options = self._init()
        self._service = _output(
            *("docker", "run", "--detach", *self._options, *given, f"--entrypoint={init}"),
            *(f"--publish=127.0.0.1:{port}:8000", self.image, *options, *service),
        )
        try:
            yield
        finally:
            _output("docker", "stop", f"--time={_STOP_S:.0f}", self._service)
            log.write_text(_output("docker", "logs", self._service))
            template = "{{.State.ExitCode}}"
            code = int(_output("docker", "inspect", "--format", template, self._service))
            _output("docker", "rm", self._service)
            self._service = ""
        if code:
            raise Failed(f"the service ended with {code}")

    def remove(self) -> None:
        """Removes the volume."""
        _output("docker", "volume", "rm", self._volume)

    def _init(self) -> list[str]:
        """Returns the command of the image's init."""
        config = json.loads(_output("docker", "image", "inspect", self.image))[0]["Config"]
        entrypoint: list[str] = config["Entrypoint"]
        return entrypoint[:-1]


def main() -> int:
    """Tries the image; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--image", default="drivora")
    parser.add_argument("--most-mb", type=float, default=900.0, help="largest size, 10^6 bytes")
    parser.add_argument("--volume", action="append", default=[], help="FOLDER:FOLDER, also mounted")
    parser.add_argument("--ray", action="store_true", help="a node of Ray performs the runs")
    options = parser.parse_args()
    engine = Buildah if shutil.which("buildah") else Docker
    container = engine(options.image, options.volume)
    log = Path(f"smoke-{os.getpid()}.log").resolve()
    try:
        _try_image(container, options.most_mb, log, with_ray=options.ray)
    except (Failed, OSError) as error:
        print(f"smoke: FAILED: {error!r}", file=sys.stderr)
        if log.is_file():
            print(log.read_text(), file=sys.stderr)
        return 1
    finally:
        log.unlink(missing_ok=True)
        container.remove()
    return 0


def _try_image(container: Buildah | Docker, most_mb: float, log: Path, *, with_ray: bool) -> None:
    size = container.size_mb()
    print(f"smoke: {container.image} has {size:.0f} MB")
    if size > most_mb:
        raise Failed(f"the image has {size:.0f} MB, more than {most_mb:.0f}")
    version, user = container.drivora("--version"), container.run("id", "--user")
    print(f"smoke: drivora {version}, user {user}")
    if user != "10001":
        raise Failed(f"the image runs as the user {user}, not as 10001")
    program = container.run("bash", "-lc", "command -v drivora || true")
    print(f"smoke: a login shell finds {program or 'no program'}")
    if not program:
        raise Failed("a login shell does not find the program: /etc/profile.d/drivora.sh")
    orphan = container.python(_ORPHAN)
    print(f"smoke: a process without a parent is {orphan}")
    if orphan != "reaped":
        raise Failed("the init of the image does not reap processes that lost their parents")
    variables = {"DRIVORA_WORKERS": "2"}
    if "DRIVORA_DATABASE_URL" in os.environ:
        variables["DRIVORA_DATABASE_URL"] = os.environ["DRIVORA_DATABASE_URL"]
        print("smoke: with a database of PostgreSQL")
    service: tuple[str, ...] = _SERVE
    if with_ray:
        head = _free_port()
        service = ("sh", "-c", _SERVE_BESIDE_RAY.format(port=head))
        variables |= {
            "DRIVORA_EXECUTOR": "ray",
            "DRIVORA_RAY_ADDRESS": f"127.0.0.1:{head}",
            "RAY_AUTH_MODE": "token",
            "RAY_AUTH_TOKEN": secrets.token_hex(32),
        }
    token = json.loads(container.drivora("tokens", "create", "smoke", "--json"))["token"]
    kernels = container.run("sh", "-c", _KERNELS)
    port = _free_port()
    url = f"http://127.0.0.1:{port}"
    begun = time.monotonic()
    with container.serving(port, log, *service, **variables):
        _wait_until_ready(url, begun + _READY_S)
        print(f"smoke: ready after {time.monotonic() - begun:.1f} s")
        if _status(f"{url}/api/v1/networks") != 401:
            raise Failed("a request without a token is not refused with 401")
        page = _get(url, "")
        if b"<title>Drivora" not in page:
            raise Failed("there is no page at /")
        begun = time.monotonic()
        for run in _judged(url, token):
            verdicts = run["verdicts"]
            violated = [one["oracle"] for one in verdicts if one["outcome"] == "violated"]
            print(
                f"smoke: {run['label']}: {run['status']}, {len(verdicts)} verdicts, violated: "
                f"{', '.join(violated) or 'none'}"
            )
            if run["status"] != "finished" or not verdicts:
                raise Failed(f"the run {run['label']} was not judged: {run}")
        print(f"smoke: batch judged after {time.monotonic() - begun:.1f} s")
        shipped = set(kernels.splitlines())
        compiled = set(container.run("sh", "-c", _KERNELS).splitlines()) - shipped
        print(f"smoke: {len(shipped)} kernels shipped, {len(compiled)} compiled anew")
        if not shipped or compiled:
            raise Failed(f"kernels were compiled anew: {sorted(compiled)}")
    print("smoke: stopped cleanly")


def _judged(url: str, token: str) -> list[dict[str, Any]]:
    """Posts two scenarios and returns their runs."""
    items = [
        {"label": name, "scenario": json.loads((_EXAMPLES / f"{name}.json").read_text())}
        for name in _SCENARIOS
    ]
    answer = json.loads(_get(f"{url}/api/v1/batches", token, json.dumps(items).encode()))
    if answer["accepted"] != len(items):
        raise Failed(f"the batch was refused: {answer}")
    batch = answer["batch"]["id"]
    ends = time.monotonic() + _RUNS_S
    while time.monotonic() < ends:
        runs = json.loads(_get(f"{url}/api/v1/runs?batch={batch}", token))["items"]
        if all(run["status"] not in ("queued", "running") for run in runs):
            return [json.loads(_get(f"{url}/api/v1/runs/{run['id']}", token)) for run in runs]
        time.sleep(0.2)
    raise Failed(f"the batch did not end within {_RUNS_S:.0f} s")


def _get(url: str, token: str, body: bytes | None = None) -> bytes:
    headers = {"Content-Type": "application/json"}
    if token:
        headers["Authorization"] = f"Bearer {token}"
    request = urllib.request.Request(url, data=body, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            content: bytes = answer.read()
            return content
    except urllib.error.HTTPError as error:
        raise Failed(f"{url} answers {error.code}: {error.read().decode()}") from error


def _status(url: str) -> int:
    try:
        with urllib.request.urlopen(url, timeout=60) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code


def _wait_until_ready(url: str, ends: float) -> None:
    while time.monotonic() < ends:
        try:
            if _status(f"{url}/readyz") == 200:
                return
        except OSError:
            pass
        time.sleep(0.1)
    raise Failed("the service is not ready")


def _wait(process: subprocess.Popen[bytes]) -> int:
    try:
        return process.wait(_STOP_S)
    except subprocess.TimeoutExpired:
        for pid in [*_descendants(process.pid), process.pid]:
            os.kill(pid, signal.SIGKILL)
        raise Failed("the service did not stop when it was asked to") from None


def _opened(pids: Iterable[int]) -> list[int]:
    """Returns files of processes, which are no other ones when their ids are given anew."""
    files = []
    for pid in pids:
        with suppress(ProcessLookupError):
            files.append(os.pidfd_open(pid))
    return files


def _wait_until_ended(pids: list[int]) -> None:
    ends = time.monotonic() + _STOP_S
    while any(_name_of(pid) for pid in pids) and time.monotonic() < ends:
        time.sleep(0.1)


def _descendants(pid: int) -> list[int]:
    try:
        threads = list(Path(f"/proc/{pid}/task").iterdir())
        text = " ".join((thread / "children").read_text() for thread in threads)
    except OSError:
        return []
    found = []
    for child in map(int, text.split()):
        found += [child, *_descendants(child)]
    return found


def _name_of(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def _output(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failed(f"`{' '.join(command[:6])} …` ended with {done.returncode}: {done.stderr}")
    return done.stdout.strip()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    sys.exit(main())
