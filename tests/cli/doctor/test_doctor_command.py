"""``drivora doctor`` as users run it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

from tests.cli.conftest import Drivora

REPOSITORY = Path(__file__).parents[3]


def test_the_text_is_fit_for_a_bug_report(drivora: Drivora, tmp_path: Path) -> None:
    secret = drivora("tokens", "create", "ci").out.strip()
    done = drivora(
        "doctor",
        "--port",
        "0",
        HOME=str(tmp_path),
        DRIVORA_TOKEN=secret,
        DRIVORA_DATABASE_URL="postgresql+psycopg://user:hunter2@db.example/drivora",
        DRIVORA_WORKRES="3",
    )
    assert done.code == 3, done
    for hidden in (secret, "hunter2", str(tmp_path)):
        assert hidden not in done.out + done.err
    assert "~/data" in done.out
    assert "DRIVORA_WORKRES is no variable of Drivora" in done.out
    assert "Did you mean DRIVORA_WORKERS?" in done.out
    assert "db.example" in done.out
    assert re.fullmatch(r"[1-9] problems?, [1-9] notes?", done.out.splitlines()[-1])
    words = {line[:9].strip() for line in done.out.splitlines()[:-2]}
    assert words <= {"ok", "note", "problem", ""}
    assert max(map(len, done.out.splitlines())) <= 200


def test_broken_packages_prevent_no_other_check(tmp_path: Path) -> None:
    """numpy, packaging and libsumo cannot be imported, and a plug-in ends its process."""
    site = tmp_path / "site"
    for name in ("numpy", "packaging", "libsumo"):
        (site / name).mkdir(parents=True)
        (site / name / "__init__.py").write_text(f"raise ImportError('{name} is broken here')\n")
    (site / "rude.py").write_text("import os\nos._exit(7)\n")
    (site / "faulty.py").write_text("value = 1\n\n1 / 0\n")
    info = site / "rude-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: rude\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.oracles]\nrude = rude:ORACLE\nfaulty = faulty:ORACLE\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", "doctor", "--json", "--port", "0"],
        env={
            **os.environ,
            "PYTHONPATH": f"{site}{os.pathsep}{REPOSITORY}",
            "DRIVORA_DATA_DIR": str(tmp_path / "data"),
        },
        capture_output=True,
        text=True,
        check=False,
        timeout=240,
    )
    assert done.returncode == 3, done.stderr
    content = json.loads(done.stdout)
    found: dict[str, list[str]] = {}
    for finding in content["findings"]:
        found.setdefault(finding["subject"], []).append(f"{finding['state']} {finding['found']}")
    assert "packaging is broken here" in found["packages"][0]
    assert "libsumo is broken here" in found["libsumo"][0]
    assert found["speed"][0].startswith(("problem", "note speed not measured", "note not measured"))
    faults = " ".join(found["plug-ins"])
    assert "rude of rude 1.0 cannot be loaded: its process ended with 7" in faults
    assert f"ZeroDivisionError: division by zero ({site / 'faulty.py'}, line 3)" in faults
    for whole in ("Python", "data folder", "database", "tokens", "port", "environment"):
        assert found[whole][-1].startswith("ok"), found[whole]
    assert content["problems"] == sum(
        finding["state"] == "problem" for finding in content["findings"]
    )
