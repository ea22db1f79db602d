"""The time of a real server to refuse broken documents.

A fresh server on an idle machine gets every broken document of the tests one after another, the
first one at once, then each again. Times are those of a client, with the way there and back.

    python -m benchmarks.bad_input
"""

from __future__ import annotations

import argparse
import copy
import json
import statistics
import tempfile
import time
from pathlib import Path

import httpx

from drivora_service.cli.application.service_process import run_service
from tests.scenario.conftest import GOOD
from tests.scenario.test_bad_input import BROKEN

_JSON = {"Content-Type": "application/json"}


def bodies() -> dict[str, bytes]:
    """Returns the documents by name; the valid one comes first."""
    made = {"(nothing wrong)": json.dumps(GOOD).encode()}
    for name, (change, _) in BROKEN.items():
        content = change(copy.deepcopy(GOOD))
        text = content if isinstance(content, str | bytes) else json.dumps(content)
        made[name] = text if isinstance(text, bytes) else text.encode()
    return made


def measure(client: httpx.Client, path: str) -> dict[str, float]:
    """Returns the seconds of each answer."""
    seconds = {}
    for name, body in bodies().items():
        begun = time.perf_counter()
        answer = client.post(path, content=body, headers=_JSON)
        seconds[name] = time.perf_counter() - begun
        assert answer.is_client_error == (name in BROKEN), (name, answer.status_code)
    return seconds


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--slowest", type=int, default=5, help="how many answers to list")
    options = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as name,
        run_service(Path(name), workers=1) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client,
    ):
        for turn in ("first", "second"):
            seconds = measure(client, "/scenarios:validate")
            print(
                f"{turn} time: median {1e3 * statistics.median(seconds.values()):.1f} ms; slowest"
            )
            for document in sorted(seconds, key=seconds.__getitem__, reverse=True)[
                : options.slowest
            ]:
                print(f"  {1e3 * seconds[document]:7.1f} ms  {document}")


if __name__ == "__main__":
    main()
