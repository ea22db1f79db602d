"""Values of objectives by name."""

from __future__ import annotations

from typing import NoReturn

from drivora_service.errors import UnknownObjective


class ObjectiveValues(dict[str, float | None]):
    """Values of objectives, which refuse names that were not measured.

    ``None`` is the value of an objective that was measured but is not measurable in this run. A
    misspelt name must not look like it: a search would go by less than it says.
    """

    __slots__ = ()

    def __missing__(self, name: str) -> NoReturn:
        """Refuses a name.

        Raises:
            UnknownObjective: Always; it names the known ones.
        """
        raise UnknownObjective(name, tuple(self))

    def get(self, name: str, default: float | None = None) -> float | None:  # type: ignore[override] # no overloads
        """Returns the value of an objective; the default if it is not measurable.

        Raises:
            UnknownObjective: There is no objective of that name.
        """
        value = self[name]
        return default if value is None else value
