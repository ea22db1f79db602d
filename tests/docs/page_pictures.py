"""Pictures of the web page for the documentation, and the animation of a replay."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from benchmarks.page import WEB
from drivora_service.cli.application.service_process import run_service
from drivora_service.cli.studies.study_files import read_study_file
from drivora_service.client import Client
from drivora_service.dashboard.build import node_program

_ROOT = Path(__file__).resolve().parents[2]
_EXAMPLES = _ROOT / "openscenario_schemas" / "examples"
_STUDY = _EXAMPLES / "studies" / "three-methods.yaml"


def draw_page_pictures(data: Path, images: Path) -> None:
    """Runs scenarios and a study on a real service, and takes pictures of its page in a browser.

    Args:
        data: Folder for the data of the service.
        images: Folder for the pictures.
    """
    with run_service(data, workers=2) as url, Client(url) as client:
        study = client.post_study(json.dumps(read_study_file(_STUDY).content))
        client.follow_study(study.id)
        cases = sorted((_EXAMPLES / "responsibility").glob("*.json"))
        files = [
            _EXAMPLES / "walker-behind-van.json",
            *(file for file in cases if file.stem != "cases"),
        ]
        texts = [file.read_text() for file in files]
        batch = client.post_batch(texts, labels=[file.stem for file in files], name="seeds").batch
        runs = sorted(client.wait_for_batch(batch.id), key=lambda run: run.item)
        script = "browser/pictures.ts"
        subprocess.run(
            [str(node_program()), script, url, runs[0].id, str(images)], cwd=WEB, check=True
        )
