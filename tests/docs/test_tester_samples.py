"""The testers of the how-to that let libraries choose candidates pass the contract of testers."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import venv
from importlib.util import find_spec
from pathlib import Path

import pytest

_PAGE = "docs/how-to/write-a-tester.md"
_FILE = re.compile(r"^<!-- file: samplers/(\w+\.py) -->\n```python\n(.*?)^```$", re.S | re.M)
_SUITE = """
from drivora_service.search.genes import GeneSpace
from drivora_service.search.tester import Evaluation
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract
from {module} import {name}


class TestSample(TesterContract):
    plugin = {name}
    budget = 80

    def space(self) -> GeneSpace:
        # Optuna draws gene by gene.
        return small_space(egos=2, vehicles=1, walkers=1, slices=2)

    def test_it_finds_better_candidates_than_it_begins_with(self) -> None:
        def mean(told: list[Evaluation]) -> float:
            costs = [e.measurement.objectives["min_gap"] for e in told if e.measurement]
            return sum(costs) / len(costs)

        told = self.play(self.create(), self.budget, 4)
        assert mean(told[-30:]) < 0.9 * mean(told[:10])
"""


def run_suite(folder: Path, module: str, name: str, repository: Path, python: Path) -> None:
    """Writes the files of the page, and runs the suite of a tester on one of them."""
    written = dict(_FILE.findall((repository / _PAGE).read_text()))
    assert set(written) == {"pymoo_tester.py", "optuna_tester.py"}
    for file, text in written.items():
        (folder / file).write_text(text)
    suite = folder / f"test_{module}_sample.py"
    suite.write_text(_SUITE.format(module=module, name=name))
    done = subprocess.run(
        [python, "-W", "error", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist",
         suite],
        cwd=folder,
        env={"PYTHONPATH": str(repository), "PATH": str(python.parent)},
        capture_output=True,
        text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    # A test that was skipped was not run.
    last = done.stdout.strip().splitlines()[-1]
    assert re.fullmatch(r"\d+ passed in .*", last), last


def test_the_sample_with_pymoo_is_a_tester(repository: Path, tmp_path: Path) -> None:
    run_suite(tmp_path, "pymoo_tester", "PYMOO", repository, Path(sys.executable))


@pytest.mark.slow(seconds=60)
def test_the_sample_with_optuna_is_a_tester(repository: Path, tmp_path: Path) -> None:
    python = Path(sys.executable)
    if find_spec("optuna") is None:
        python = environment_with_optuna(tmp_path / "environment")
    run_suite(tmp_path, "optuna_tester", "OPTUNA", repository, python)


def environment_with_optuna(folder: Path) -> Path:
    """Returns the Python of an environment with Optuna and the packages of this one."""
    venv.create(folder)
    python = folder / "bin" / "python"
    (packages,) = folder.glob("lib/python*/site-packages")
    base = sysconfig.get_path("purelib")
    (packages / "base.pth").write_text(f"import site; site.addsitedir({base!r})\n")
    done = subprocess.run(
        [sys.executable, "-m", "uv", "pip", "install", "--quiet", "--python", python, "optuna>=4"],
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        pytest.skip(f"Optuna cannot be installed here: {done.stderr.strip().splitlines()[-1]}")
    return python
