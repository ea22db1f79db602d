"""The script that builds the image: its options and exit codes, with a stand-in for buildah."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

_BUILDAH = """#!/bin/sh
echo "$*" >> "$CALLS"
[ "$1" != build ] || exit "$BUILD_ENDS_WITH"
[ "$1" != run ] || exit "$RUN_ENDS_WITH"
"""


def build(
    repository: Path, folder: Path, *options: str, ends_with: int = 0, run_ends_with: int = 0
) -> tuple[int, list[str]]:
    """Runs the script; returns its exit code, and the options of the build, none if there is none.

    Args:
        repository: The checkout.
        folder: Folder for the stand-in.
        options: Options of the script.
        ends_with: Exit code of the build.
        run_ends_with: Exit code of a command in a container.
    """
    programs = folder / "bin"
    programs.mkdir(exist_ok=True)
    (programs / "buildah").write_text(_BUILDAH)
    (programs / "buildah").chmod(0o755)
    calls = folder / "calls"
    done = subprocess.run(
        [str(repository / "deploy" / "image" / "build.sh"), *options],
        env={
            "PATH": f"{programs}:/usr/bin:/bin",
            "CALLS": str(calls),
            "BUILD_ENDS_WITH": str(ends_with),
            "RUN_ENDS_WITH": str(run_ends_with),
        },
        timeout=60,
        check=False,
    )
    built = [call for call in calls.read_text().splitlines() if call.startswith("build ")]
    assert len(built) <= 1
    return done.returncode, " ".join(built).split()


@pytest.mark.parametrize("code", [1, 3, 125])
def test_a_build_that_fails_is_no_lack_of_tools(
    repository: Path, tmp_path: Path, code: int
) -> None:
    # 3 says that no image can be built here, and is the exit code of commands of Drivora, too.
    assert build(repository, tmp_path, ends_with=code)[0] == 1


def test_where_no_container_can_run_no_image_is_built(repository: Path, tmp_path: Path) -> None:
    assert build(repository, tmp_path, run_ends_with=1) == (3, [])


@pytest.mark.parametrize(
    "options",
    [("--tag", "mine", "--build-arg", "WITH=x"), ("--build-arg", "WITH=x", "--tag", "mine")],
)
def test_the_tag_may_be_anywhere(repository: Path, tmp_path: Path, options: tuple[str]) -> None:
    code, built = build(repository, tmp_path, *options)
    assert code == 0
    tags = [built[number + 1] for number, one in enumerate(built) if one == "--tag"]
    assert tags == ["mine"]
    assert "WITH=x" in built


def test_the_image_has_a_name_without_a_tag(repository: Path, tmp_path: Path) -> None:
    built = build(repository, tmp_path)[1]
    assert built[built.index("--tag") + 1] == "drivora"
