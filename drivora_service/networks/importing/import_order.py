"""What a process that imports an uploaded file is told, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass, field

from drivora_service.networks.importing.source_formats import SourceFormat

SOURCE, MADE, RESULT, PRINTED = "source", "new", "result.json", "printed"
"""Names in the folder of an import: the uploaded file, the folder of the network that is made, the
result, and what the process has printed."""

ENDING_S = 1.0
"""Seconds in which a process that is told to end (SIGTERM) ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportLimits:
    """Limits of the process of an import.

    Attributes:
        wall_s: Seconds from its start to its end.
        cpu_s: Seconds of processor time, for itself and for netconvert each.
        memory_bytes: Address space while it reads files. A service that has the network and each of
            its workers will need about as much.
        conversion_memory_bytes: Address space of netconvert.
        file_bytes: Size of each file that is written.
    """

    wall_s: float = 120.0
    cpu_s: int = 120
    memory_bytes: int = 1 << 30
    conversion_memory_bytes: int = 3 << 30
    file_bytes: int = 256 << 20


def too_much_memory(limits: ImportLimits) -> str:
    """Returns why a network is refused that needs too much memory."""
    return (
        f"the network needs more memory than the {limits.memory_bytes >> 20} MiB that an import "
        "may use; cut out the part that is needed"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportOrder:
    """What is to be imported.

    Attributes:
        format: Format of the file.
        name: Name of the network.
    """

    format: SourceFormat
    name: str
    limits: ImportLimits = field(default_factory=ImportLimits)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportResult:
    """The result of an import; the network is made if it has neither of these.

    Attributes:
        refusal: Why the file cannot be used.
        storage_fault: Why nothing can be written.
    """

    refusal: str = ""
    storage_fault: str = ""
