"""Real reverse proxies for tests, with the configurations of the operators' page.

Caddy comes with the development tools. nginx is used where the machine has it, which CI sees to.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PAGE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "operate-the-service.md"
_SERVICE = "127.0.0.1:8000"
_START_S = 30.0

PROXIES = ("caddy", "caddy-strips", "nginx", "nginx-strips")
"""Kinds of proxies: each passes the whole path on, or takes the prefix off."""


NO_PROXY = 3
"""Exit code where the program of a proxy is not there."""


def find_proxy(kind: str) -> str | None:
    """Returns the program of a kind of proxy; ``None`` where there is none."""
    name = kind.partition("-")[0]
    places = [str(Path(sys.executable).parent), os.environ.get("PATH", ""), "/usr/sbin"]
    return shutil.which(name, path=os.pathsep.join(places))


@contextmanager
def reverse_proxy(kind: str, service: str, folder: Path) -> Iterator[str]:
    """Starts a proxy that has a service under ``/drivora``, and yields the address there.

    Args:
        kind: One of :data:`PROXIES`; its program must be there.
        service: Host and port of the service.
        folder: Where its files are.
    """
    program = find_proxy(kind)
    assert program is not None
    folder.mkdir()
    port = _free_port()
    command = (_nginx if kind.startswith("nginx") else _caddy)(kind, service, folder, port)
    log = folder / "proxy.log"
    with log.open("wb") as out:
        environment = {**os.environ, "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
        process = subprocess.Popen([program, *command], stdout=out, stderr=out, env=environment)
    try:
        _wait_for(port, process, log)
        yield f"http://127.0.0.1:{port}/drivora"
    finally:
        # At once: they would wait for streams of events, which last.
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def documented(language: str) -> str:
    """Returns the configuration of the operators' page in a language."""
    found = re.findall(rf"^```{language}\n(.*?)^```$", _PAGE.read_text(), re.DOTALL | re.MULTILINE)
    assert len(found) == 1
    text: str = found[0]
    return text


def _nginx(kind: str, service: str, folder: Path, port: int) -> list[str]:
    location = documented("nginx").replace(_SERVICE, service)
    if kind.endswith("strips"):
        location = location.replace(f"{service};", f"{service}/;")
    places = "\n".join(
        f"{name}_temp_path {folder}/{name};"
        for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    config = folder / "nginx.conf"
    config.write_text(
        f"daemon off; pid {folder}/nginx.pid; error_log stderr; worker_processes 1;\n"
        + ("user root;\n" if os.geteuid() == 0 else "")
        + f"events {{}}\nhttp {{ access_log off; {places}\n"
        f"server {{ listen 127.0.0.1:{port}; {location} }} }}\n"
    )
    return ["-c", str(config), "-p", str(folder), "-e", "stderr"]


def _caddy(kind: str, service: str, folder: Path, port: int) -> list[str]:
    site = documented("caddyfile").replace(_SERVICE, service)
    # Without TLS, whose certificates it would ask the owner of the host's name for.
    site = re.sub(r"^host \{", f"http://127.0.0.1:{port} {{", site)
    if kind.endswith("strips"):
        site = site.replace("handle ", "handle_path ")
    config = folder / "Caddyfile"
    config.write_text(f"{{\n\tadmin off\n\tpersist_config off\n\tgrace_period 100ms\n}}\n{site}")
    return ["run", "--config", str(config), "--adapter", "caddyfile"]


def _free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
    return port


def _wait_for(port: int, process: subprocess.Popen[bytes], log: Path) -> None:
    deadline = time.monotonic() + _START_S
    while process.poll() is None and time.monotonic() < deadline:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
        except OSError:
            time.sleep(0.02)
        else:
            return
    raise AssertionError(f"the proxy does not listen:\n{log.read_text()}")


def main(arguments: list[str]) -> int:
    """Runs a proxy until the standard input ends: ``KIND SERVICE FOLDER``; prints its address."""
    kind, service, folder = arguments
    if find_proxy(kind) is None:
        return NO_PROXY
    with reverse_proxy(kind, service, Path(folder)) as url:
        print(url, flush=True)
        sys.stdin.read()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
