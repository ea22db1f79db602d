"""The extra `adversary` can be installed, and the tests of what needs it pass with it.

It has a library for learning that is too large for the development tools. So the tests run in an
environment of their own, which has the packages of this one and those of the extra.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
import tomllib
import venv
from importlib.util import find_spec
from pathlib import Path

import pytest

TESTS = (
    "tests/search/testers/test_deepcollision.py",
    "tests/campaigns/test_deepcollision_campaigns.py",
    "tests/campaigns/test_patches.py::"
    "test_the_number_of_workers_does_not_change_a_campaign_with_patches[deepcollision]",
)


@pytest.mark.slow(seconds=300)
@pytest.mark.skipif(
    find_spec("stable_baselines3") is not None, reason="installed: these tests ran themselves"
)
def test_what_needs_the_extra_passes_with_it(repository: Path, tmp_path: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    environment = tmp_path / "environment"
    venv.create(environment)
    python = environment / "bin" / "python"
    (packages,) = environment.glob("lib/python*/site-packages")
    base = sysconfig.get_path("purelib")
    (packages / "base.pth").write_text(f"import site; site.addsitedir({base!r})\n")
    subprocess.run(
        [
            sys.executable, "-m", "uv", "pip", "install", "--quiet", "--python", python,
            # It does not see the packages of this environment: it installs the same versions.
            "--constraints", repository / "requirements" / "dev.txt",
            *project["optional-dependencies"]["adversary"],
        ],
        check=True,
    )  # fmt: skip
    done = subprocess.run(
        [python, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", *TESTS],
        cwd=repository,
        env={**os.environ, "PYTHONPATH": str(repository)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    # A test that was skipped was not run.
    last = done.stdout.strip().splitlines()[-1]
    assert re.fullmatch(r"\d+ passed in .*", last), last
    assert sys.executable != str(python)
