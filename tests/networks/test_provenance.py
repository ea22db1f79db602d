from pathlib import Path

import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.provenance import FILE_NAME, Provenance, read_provenance


def test_what_is_written_can_be_read(tmp_path: Path) -> None:
    provenance = Provenance(
        title="Quarter",
        description="Ein Viertel: “quoted”, with a # and a colon.",
        source="quarter.osm",
        licence="ODbL-1.0, © OpenStreetMap contributors",
        source_sha256="0" * 64,
        netconvert="1.28.0",
        options=("--junctions.join", "true"),
    )
    (tmp_path / FILE_NAME).write_text(provenance.to_yaml(), encoding="utf-8")
    assert read_provenance(tmp_path) == provenance


@pytest.mark.parametrize(
    "content",
    [None, b"", b"title: [", b"- a\n- b\n", b"title: only\n", b"\xff\xfe\x00", b"!!python/name:os"],
)
def test_a_file_that_is_missing_or_something_else(tmp_path: Path, content: bytes | None) -> None:
    directory = tmp_path / "quarter"
    directory.mkdir()
    if content is not None:
        (directory / FILE_NAME).write_bytes(content)
    with pytest.raises(NetworkError, match=r"provenance\.yaml of network 'quarter'"):
        read_provenance(directory)
