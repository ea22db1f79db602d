"""What runs in the environment of an ADS needs nothing that the ADS did not bring."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from grpc_tools import protoc

from drivora_service.agents import remote

ROOT = Path(__file__).resolve().parents[3]
PROTO = "drivora_service/agents/remote/agent.proto"
ALLOWED = ("google", "grpc", "numpy", "typing_extensions", "drivora_service")

BLOCKED = f"""
import sys, importlib.abc

class Refusing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top not in sys.stdlib_module_names and top not in {ALLOWED}:
            raise ModuleNotFoundError(f"blocked: {{name}}")

sys.meta_path.insert(0, Refusing())
import drivora_service.agents.remote.serving
import drivora_service.agents.remote.views
print(*sorted({{name.partition(".")[0] for name in sys.modules}}))
"""


def test_an_adapter_needs_grpc_protobuf_and_numpy_only() -> None:
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "drivora_service" in done.stdout
    assert "pydantic" not in done.stdout.split()


def test_without_an_address_serving_says_what_to_do() -> None:
    code = "from drivora_service.agents.remote.serving import serve; serve(object)"
    environment = {k: v for k, v in os.environ.items() if k != "DRIVORA_AGENT_ADDRESS"}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env={**environment, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "set DRIVORA_AGENT_ADDRESS to unix:PATH or HOST:PORT" in done.stderr


def test_the_generated_files_are_what_the_pinned_generator_makes(tmp_path: Path) -> None:
    outputs = [f"--{kind}_out={tmp_path}" for kind in ("python", "pyi", "grpc_python")]
    assert protoc.main(["protoc", f"-I{ROOT}", *outputs, str(ROOT / PROTO)]) == 0
    committed = Path(remote.__file__).parent
    made = sorted(path for path in tmp_path.rglob("*") if path.is_file())
    assert [path.name for path in made] == ["agent_pb2.py", "agent_pb2.pyi", "agent_pb2_grpc.py"]
    for path in made:
        assert path.read_text() == (committed / path.name).read_text(), (
            f"make {path.name} again: `make protocol`"
        )
