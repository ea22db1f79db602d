"""The notebook of the documentation, run as it is committed."""

from __future__ import annotations

import os
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import nbformat
import pytest
from nbclient import NotebookClient

_NOTEBOOK = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "explore-results.ipynb"
_TIME_LIMIT_S = 300


def _read() -> Any:
    return nbformat.read(_NOTEBOOK, as_version=nbformat.NO_CONVERT)


def test_the_notebook_is_small_and_without_outputs() -> None:
    notebook = _read()
    nbformat.validate(notebook)
    assert notebook.nbformat == 4
    assert _NOTEBOOK.stat().st_size < 20_000
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert cell.outputs == []
            assert cell.execution_count is None


def test_no_link_of_the_notebook_is_dead() -> None:
    texts = [cell.source for cell in _read().cells if cell.cell_type == "markdown"]
    links = re.findall(r"\]\(([^)\s]+)\)", "\n".join(texts))
    assert len(links) >= 2
    for link in links:
        assert (_NOTEBOOK.parent / link).resolve().is_file(), link


@pytest.mark.slow(seconds=40)
def test_the_notebook_runs(
    service_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = str(_NOTEBOOK.parents[2])
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    monkeypatch.setenv("PATH", path)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([root, os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("DRIVORA_SERVER", service_url)
    notebook = _read()
    NotebookClient(
        notebook,
        timeout=_TIME_LIMIT_S,
        kernel_name="python3",
        resources={"metadata": {"path": str(tmp_path)}},
    ).execute()

    outputs = [
        output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs
    ]
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 2
    # The cell that counts violations says what the service has.
    (shown,) = (
        cell.outputs[0].data["text/plain"]
        for cell in notebook.cells
        if cell.source.endswith("\nby_oracle")
    )
    head, _, *rows = shown.splitlines()
    agents = head.split()[1:]
    found = {
        (oracle, agent): int(number)
        for oracle, *numbers in map(str.split, rows)
        for agent, number in zip(agents, numbers, strict=True)
        if int(number)
    }
    assert found == _violations(service_url)
    assert (tmp_path / "verdicts.parquet").is_file()


def _violations(service_url: str) -> dict[tuple[str, str], int]:
    """Counts the violations in the batches of the notebook, run by run over HTTP."""
    counts: Counter[tuple[str, str]] = Counter()
    with httpx.Client(base_url=f"{service_url}/api/v1", timeout=60) as client:
        batches = client.get("/batches?limit=500").json()["items"]
        ids = [one["id"] for one in batches if one["name"].startswith("explore ")]
        assert len(ids) == 2
        for batch in ids:
            runs = client.get(f"/runs?batch={batch}&limit=500").json()["items"]
            assert len(runs) == 10
            for listed in runs:
                run = client.get(f"/runs/{listed['id']}").json()
                counts.update(
                    (verdict["oracle"], run["agent"])
                    for verdict in run["verdicts"]
                    if verdict["outcome"] == "violated"
                )
    assert counts
    return dict(counts)
