"""Values of PostgreSQL that SQLite has otherwise; imported only where the driver is installed."""

from __future__ import annotations

from psycopg.abc import AdaptContext, Buffer
from psycopg.adapt import AdaptersMap, Loader
from psycopg.types.string import StrDumperUnknown


def adapt_values(adapters: AdaptersMap) -> None:
    """Has a connection write and read values as one to SQLite does."""
    adapters.register_dumper(str, _TextDumper)
    adapters.register_loader("numeric", _NumberLoader)


class _TextDumper(StrDumperUnknown):
    """Writes text; NUL, which PostgreSQL cannot store, becomes the replacement character.

    The API refuses NUL in all that it is sent, so only the output and messages of simulators, ADSs
    and plug-ins have it. A run must not be lost by a log.
    """

    def dump(self, obj: str) -> Buffer | None:
        """Returns the text's bytes."""
        return super().dump(obj.replace("\0", "�") if "\0" in obj else obj)


class _NumberLoader(Loader):
    """Reads sums and means of integers, which PostgreSQL computes as decimal numbers."""

    def __init__(self, oid: int, context: AdaptContext | None = None) -> None:
        super().__init__(oid, context)

    def load(self, data: Buffer) -> int | float:
        """Returns an integer for a number without decimal places, else a float."""
        written = bytes(data)
        return float(written) if b"." in written or written == b"NaN" else int(written)
