"""Imports in a process with limits: what is made, what is refused, and what is left of neither."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.importing.confined_import import import_confined
from drivora_service.networks.importing.import_order import MADE, SOURCE, ImportLimits, ImportOrder
from drivora_service.networks.importing.network_importing import import_network
from drivora_service.networks.importing.source_formats import SourceFormat
from drivora_service.networks.provenance import read_provenance
from drivora_service.shapes import to_json
from tests.networks.broken_sources import SOURCES, opendrive, road
from tests.networks.importing.test_network_importing import OSM

ENDLESS = "OSM, way of one node over and over"


def order(form: SourceFormat, limits: ImportLimits | None = None) -> ImportOrder:
    return ImportOrder(format=form, name="place", limits=limits or ImportLimits())


def staged(folder: Path, data: bytes) -> Path:
    """A folder of an upload, with the file."""
    stage = folder / ".uploading-x"
    stage.mkdir()
    (stage / SOURCE).write_bytes(data)
    return stage


def refusal(given: ImportOrder, stage: Path) -> str:
    with pytest.raises(NetworkError) as raised:
        import_confined(given, stage, threading.Event())
    assert processes_in(stage) == []
    return str(raised.value)


def processes_in(folder: Path) -> list[psutil.Process]:
    """The processes that work in a folder."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if Path(process.cwd()) == folder and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found


def wait_until(holds: Callable[[], object], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def many_lanes(count: int) -> bytes:
    """A network of so many streets beside each other."""
    lanes = "".join(
        f'<edge id="{i}" from="a" to="b"><lane id="{i}_0" index="0" speed="9" length="9" '
        f'shape="0,{i % 999} 9,{i % 999}"/></edge>'
        for i in range(count)
    )
    junctions = "".join(
        f'<junction id="{name}" type="priority" x="0" y="0" incLanes="" intLanes=""/>'
        for name in "ab"
    )
    location = (
        '<location netOffset="0,0" convBoundary="0,0,9,999" origBoundary="0,0,9,9" '
        'projParameter="!"/>'
    )
    return f'<net version="1.20">{location}{lanes}{junctions}</net>'.encode()


def test_the_network_is_the_same_as_without_a_process(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    source = tmp_path / "quarter.osm"
    source.write_text(OSM)
    known = import_network(source, "place", tmp_path / "networks").read_bytes()
    stage = staged(tmp_path, OSM.encode())
    import_confined(order(SourceFormat.OPENSTREETMAP), stage, threading.Event())
    assert (stage / MADE / "place.net.xml").read_bytes() == known
    provenance = read_provenance(stage / MADE)
    assert provenance.source == "an uploaded file"
    assert provenance.netconvert


def test_refusals_name_no_folder_of_the_service(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    stage = staged(tmp_path, b"<OpenDRIVE><road id='1' length='x'/></OpenDRIVE>")
    said = refusal(order(SourceFormat.OPENDRIVE), stage)
    assert said.startswith("cannot import the file: netconvert failed: ")
    assert str(tmp_path) not in said


@pytest.mark.parametrize(
    ("limits", "says"),
    [
        (ImportLimits(memory_bytes=190 << 20), "more memory than the 190 MiB"),
        (ImportLimits(cpu_s=1), "more than 1 s of processor time"),
        (ImportLimits(wall_s=1.5), r"did not finish within 1\.5 s; cut out"),
        (ImportLimits(file_bytes=10_000), "cannot be written: File too large"),
    ],
)
def test_a_network_beyond_a_limit(tmp_path: Path, limits: ImportLimits, says: str) -> None:
    stage = staged(tmp_path, many_lanes(50_000))
    with pytest.raises(NetworkError, match=says):
        import_confined(order(SourceFormat.SUMO, limits), stage, threading.Event())
    assert processes_in(stage) == []


def test_a_conversion_beyond_the_limit_of_memory(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    limits = ImportLimits(memory_bytes=300 << 20, conversion_memory_bytes=300 << 20)
    roads = opendrive(*(road(str(i), y=str(20 * i)) for i in range(30_000)))
    said = refusal(order(SourceFormat.OPENDRIVE, limits), staged(tmp_path, roads.encode()))
    assert "netconvert crashed" in said or "netconvert failed" in said


def test_netconvert_ends_with_the_time(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    stage = staged(tmp_path, SOURCES[ENDLESS].make())
    limits = ImportLimits(wall_s=3.0)
    assert "did not finish within 3 s" in refusal(order(SourceFormat.OPENSTREETMAP, limits), stage)


def test_an_import_that_is_cancelled_ends_at_once(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    stage = staged(tmp_path, SOURCES[ENDLESS].make())
    cancelled = threading.Event()
    timer = threading.Timer(2.0, cancelled.set)
    timer.start()
    with pytest.raises(NetworkError, match="was cancelled"):
        import_confined(order(SourceFormat.OPENSTREETMAP), stage, cancelled)
    assert processes_in(stage) == []


@pytest.mark.parametrize(
    ("number", "says"),
    [(signal.SIGKILL, "was killed, as happens where memory is short"), (signal.SIGSEGV, "SIGSEGV")],
)
def test_a_process_that_dies(tmp_path: Path, number: signal.Signals, says: str) -> None:
    stage = staged(tmp_path, many_lanes(50_000))

    def kill() -> None:
        wait_until(lambda: processes_in(stage))
        (process,) = processes_in(stage)
        process.send_signal(number)

    killer = threading.Thread(target=kill)
    killer.start()
    assert says in refusal(order(SourceFormat.SUMO), stage)
    killer.join()


PARENT = """
import sys, threading
from pathlib import Path
from drivora_service.networks.importing.confined_import import import_confined
from drivora_service.networks.importing.import_order import ImportOrder
from drivora_service.shapes import adapter
given = adapter(ImportOrder).validate_json(sys.argv[1])
import_confined(given, Path(sys.argv[2]), threading.Event())
"""


def test_an_import_ends_with_a_service_that_is_killed(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    stage = staged(tmp_path, SOURCES[ENDLESS].make())
    given = to_json(ImportOrder, order(SourceFormat.OPENSTREETMAP)).decode()
    environment = {**os.environ, "DRIVORA_TOKEN": "drv_secret"}
    with subprocess.Popen([sys.executable, "-c", PARENT, given, stage], env=environment) as parent:
        # The process, and netconvert.
        wait_until(lambda: len(processes_in(stage)) == 2)
        children = processes_in(stage)
        for child in children:
            assert "DRIVORA_TOKEN" not in child.environ()
            assert child.nice() > psutil.Process(parent.pid).nice()
        parent.kill()
    wait_until(lambda: processes_in(stage) == [], 10.0)
