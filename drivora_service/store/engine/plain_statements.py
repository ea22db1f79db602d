"""Statements for many rows, which go to the driver as text and plain tuples.

SQLAlchemy writes the text of a statement once, and then handles every row: it looks up each
parameter by name and converts each value by a function of its type. For the rows of the queue that
costs as much as the database itself. Here the order of the parameters is read once from the
compiled statement, and only values of types that the driver does not know are converted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from typing import Any

from sqlalchemy import Boolean, Connection, Delete, Dialect, Insert, Update

Row = dict[str, Any]
"""Values of a statement by the names of its parameters."""

_KNOWN_TIMES = 256
"""Converted values that are kept of each column: those of the runs that one transaction writes."""

_Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Plain:
    """A statement as the driver takes it.

    Attributes:
        text: Its text, with parameters by position.
        values: Returns the values of a row in the order of the parameters.
        converted: Places of the values that the driver does not know, with their conversions.
    """

    text: str
    values: Callable[[Row], tuple[Any, ...]]
    converted: tuple[tuple[int, _Convert], ...]

    def parameters(self, rows: Sequence[Row]) -> list[tuple[Any, ...]]:
        """Returns the values of all rows."""
        found = list(map(self.values, rows))
        if not self.converted:
            return found
        columns: list[Any] = list(zip(*found, strict=True))
        for place, convert in self.converted:
            columns[place] = map(convert, columns[place])
        return list(zip(*columns, strict=True))


def execute_many(
    connection: Connection, statement: Insert | Update | Delete, rows: Sequence[Row]
) -> None:
    """Executes a statement for each of ``rows``, which have the same names.

    Args:
        connection: Connection of the transaction.
        statement: One that is made once and kept; its parameters are the names of the rows.
        rows: Values by the names of the parameters; none: nothing is done.
    """
    if not rows:
        return
    plain = _plain(connection.dialect, statement, tuple(rows[0]))
    if plain is None:
        connection.execute(statement, rows)
    else:
        connection.exec_driver_sql(plain.text, plain.parameters(rows))


@lru_cache(maxsize=256)
def _plain(
    dialect: Dialect, statement: Insert | Update | Delete, names: tuple[str, ...]
) -> _Plain | None:
    """Compiles a statement; ``None``: its driver takes no parameters by position."""
    keys = list(names) if isinstance(statement, Insert) else None
    compiled: Any = statement.compile(dialect=dialect, column_keys=keys)
    if not compiled.positional:
        return None
    order: list[str] = list(compiled.positiontup)
    converted = []
    for place, name in enumerate(order):
        convert = _conversion(dialect, compiled.binds[name].type)
        if convert is not None:
            converted.append((place, convert))
    return _Plain(text=str(compiled), values=_values_of(order), converted=tuple(converted))


def _values_of(names: Sequence[str]) -> Callable[[Row], tuple[Any, ...]]:
    """Returns the function of a row that returns the values of ``names``."""
    found = itemgetter(*names)
    return found if len(names) > 1 else lambda row: (found(row),)


def _conversion(dialect: Dialect, kind: Any) -> _Convert | None:
    """Returns the function that converts a value of a type for the driver, if one is needed."""
    if isinstance(kind, Boolean):
        # Values are True, False or None already, which the check of the type would confirm.
        return None if dialect.supports_native_boolean else _as_number
    processor: _Convert | None = kind.dialect_impl(dialect).bind_processor(dialect)
    return None if processor is None else lru_cache(maxsize=_KNOWN_TIMES)(processor)


def _as_number(value: bool | None) -> int | None:
    return None if value is None else int(value)
