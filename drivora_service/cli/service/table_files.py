"""Tables that a service or the application sends, as files of the user."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from drivora_service.cli.terminal.out_option import convert_write_errors
from drivora_service.cli.terminal.output import say
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.studies.table_names import TableForm

Name = TypeVar("Name", bound=StrEnum)


class TableFormat(StrEnum):
    """The formats of tables in files."""

    PARQUET = "parquet"
    CSV = "csv"


def save_tables(
    out: Path,
    tables: Iterable[Name],
    save: Callable[[Path, Name, TableForm], None],
    *,
    formats: Collection[TableFormat] = tuple(TableFormat),
) -> None:
    """Writes tables into a folder that exists, and prints the paths of the files.

    A table in both formats is asked for once: so both files have the same rows, also where the
    store changes meanwhile.

    Args:
        out: The folder.
        tables: Names of the tables.
        save: Writes a table to a path, in a form.
        formats: In which formats.

    Raises:
        ConfigurationError: A file cannot be written.
    """
    for table in tables:
        parquet, csv = (out / f"{table}.{each}" for each in (TableFormat.PARQUET, TableFormat.CSV))
        with convert_write_errors(out):
            if TableFormat.PARQUET in formats:
                save(parquet, table, TableForm.PARQUET)
                _show(parquet)
            if TableFormat.CSV not in formats:
                continue
            if TableFormat.PARQUET in formats:
                _write_csv(parquet, csv)
            else:
                save(csv, table, TableForm.CSV)
            _show(csv)


def _write_csv(parquet: Path, csv: Path) -> None:
    from drivora_service.client.connecting import open_replacement
    from drivora_service.studies.tables.table_forms import table_chunks, table_of_file

    with open_replacement(csv) as file:
        for part in table_chunks(table_of_file(parquet), TableForm.CSV):
            file.write(part)


def _show(path: Path) -> None:
    give_to_user(path)
    say(str(path))
