"""The laws of an installation: shipped ones, and those in the user's files."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cache

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.oracles.laws.law import BrokenLawFile, Law
from drivora_service.oracles.laws.law_reading import read_laws
from drivora_service.oracles.laws.law_schema import shipped_laws
from drivora_service.oracles.laws.sources import LawSource, read_law_sources


class LawLibrary:
    """Laws by name. A law of the user never replaces an oracle that exists."""

    def __init__(self, sources: Sequence[LawSource] = (), taken: Collection[str] = ()) -> None:
        """Reads the laws.

        Args:
            sources: The user's files.
            taken: Names of other oracles.
        """
        found = {law.name: law for law in _read_shipped_laws()}
        self._shipped = tuple(found)
        self._broken: dict[str, BrokenLawFile] = {}
        for source in sources:
            try:
                laws = read_laws(source)
                self._refuse_known(laws, source.file, {*taken, *found})
            except InvalidDocument as error:
                self._add_broken(source.file, str(error))
            else:
                found.update((law.name, law) for law in laws)
        self._laws: Mapping[str, Law] = found

    def names(self) -> tuple[str, ...]:
        """Returns the names of all laws that can judge: shipped ones, then the user's."""
        return tuple(self._laws)

    def law(self, name: str) -> Law:
        """Returns a law; its name must be known."""
        return self._laws[name]

    def is_shipped(self, name: str) -> bool:
        """Returns whether a law comes with Drivora."""
        return name in self._shipped

    @property
    def broken(self) -> Mapping[str, BrokenLawFile]:
        """The files that cannot be used, by name."""
        return self._broken

    def _add_broken(self, file: str, reason: str) -> None:
        self._broken[file] = BrokenLawFile(file=file, reason=reason)

    @staticmethod
    def _refuse_known(laws: Sequence[Law], file: str, known: Collection[str]) -> None:

        again = tuple(
            Problem(
                pointer=f"/laws/{index}/name",
                code="known_name",
                message=f"{file}: there is an oracle {law.name!r} already; give the law another "
                "name",
            )
            for index, law in enumerate(laws)
            if law.name in known
        )
        if again:
            raise InvalidDocument(again)


@cache
def _read_shipped_laws() -> tuple[Law, ...]:
    return tuple(law for source in read_law_sources(shipped_laws()) for law in read_laws(source))
