"""Importing the client is light: commands that ask a service shall not wait for its parts."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = (
    "alembic",
    "drivora_service.api",
    "drivora_service.store",
    "fastapi",
    "libsumo",
    "llvmlite",
    "matplotlib",
    "numba",
    "numpy",
    "pyarrow",
    "pydantic",
    "scipy",
    "shapely",
    "sklearn",
    "sqlalchemy",
    "starlette",
    "uvicorn",
)


def loaded(program: str) -> set[str]:
    """The modules of a fresh interpreter that has run a program."""
    ended = subprocess.run(
        [sys.executable, "-c", f"{program}\nimport sys\nprint(*sys.modules)"],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return set(ended.stdout.split())


@pytest.mark.parametrize(
    "program",
    [
        "import drivora_service.client",
        "from drivora_service.client import Client\nClient('http://127.0.0.1:1').close()",
    ],
    ids=["importing", "making"],
)
def test_a_client_loads_nothing_heavy(program: str) -> None:
    modules = loaded(program)
    assert "drivora_service.client.client" in modules
    assert [name for name in HEAVY if name in modules] == []


def test_the_types_of_answers_load_neither_the_database_nor_compiled_kernels() -> None:
    program = (
        "from drivora_service.client.calls import jobs, runs, catalogues\n"
        "jobs.jobs(); jobs.job('1'); runs.run('1'); catalogues.agents(); catalogues.readiness()"
    )
    modules = loaded(program)
    assert "drivora_service.store.runs.run_records" in modules
    assert [n for n in ("sqlalchemy", "numba", "scipy", "sklearn", "fastapi") if n in modules] == []
