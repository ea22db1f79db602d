from __future__ import annotations

import os
import shutil
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.execution import infrastructure as module
from drivora_service.execution.infrastructure import Infrastructure, folder_probe


@pytest.fixture
def small_volume(tmp_path: Path) -> Iterator[Path]:
    """A volume of 4 MiB."""
    folder = tmp_path / "volume"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(folder)]
    mount = shutil.which("mount")
    if os.geteuid() != 0 or mount is None or subprocess.run(command, check=False).returncode:
        pytest.skip("only root may mount a volume")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_volume_is_a_fault_until_there_is_space(small_volume: Path) -> None:
    infrastructure = Infrastructure({"traces": folder_probe(small_volume / "traces")})
    assert infrastructure.confirm_now() == ""
    filler = small_volume / "filler"
    filler.write_bytes(bytes((4 << 20) - (200 << 10)))
    assert "KiB are free" in infrastructure.confirm_now()
    with pytest.raises(OSError, match="No space left"), filler.open("ab") as file:
        file.write(bytes(1 << 20))
    assert "No space left on device" in infrastructure.confirm_now()
    filler.unlink()
    assert infrastructure.confirm_now() == ""
    assert list((small_volume / "traces").iterdir()) == []


def test_a_file_in_the_way_is_a_fault_and_a_folder_that_is_gone_is_made_again(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "traces"
    infrastructure = Infrastructure({"traces": folder_probe(folder)})
    assert infrastructure.confirm_now() == ""
    folder.rmdir()
    assert infrastructure.confirm_now() == ""
    folder.rmdir()
    folder.write_text("in the way")
    fault = infrastructure.confirm_now()
    assert fault.startswith(f"traces: nothing can be written to {folder}")
    assert infrastructure.fault == fault


def test_the_thread_finds_that_a_fault_has_come_and_gone(tmp_path: Path) -> None:
    folder = tmp_path / "traces"
    infrastructure = Infrastructure({"traces": folder_probe(folder)})
    changed = threading.Event()
    folder.write_text("in the way")
    infrastructure.start(on_change=changed.set)
    try:
        assert changed.wait(10)
        assert infrastructure.fault
        changed.clear()
        folder.unlink()
        assert changed.wait(10)
        assert infrastructure.fault == ""
    finally:
        infrastructure.stop()


def test_a_fault_lasts_from_its_first_probe_to_the_one_that_finds_none(tmp_path: Path) -> None:
    folder = tmp_path / "traces"
    infrastructure = Infrastructure({"traces": folder_probe(folder)})
    folder.write_text("in the way")
    fault = infrastructure.confirm_now()
    assert infrastructure.fault_for(60.0) == ""
    time.sleep(0.05)
    assert infrastructure.confirm_now() == infrastructure.fault_for(0.05) == fault != ""
    folder.unlink()
    assert infrastructure.confirm_now() == infrastructure.fault_for(0.0) == ""


def test_a_probe_that_hangs_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_HANG_S", 0.1)
    hanging, let_go = threading.Event(), threading.Event()

    def hang() -> None:
        hanging.set()
        let_go.wait(10)

    infrastructure = Infrastructure({"traces": hang})
    infrastructure.start(on_change=lambda: None)
    try:
        assert hanging.wait(10)
        time.sleep(0.2)
        assert "traces: writing has not ended for 0.1 s" in infrastructure.fault
    finally:
        let_go.set()
        infrastructure.stop()
