"""The catalogue of oracles that judge every run.

These are the built-in ones, traffic laws, and those of installed packages.
"""

from __future__ import annotations

import contextlib
import inspect
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from functools import partial
from typing import Any

from pydantic_core import to_jsonable_python

from drivora_service.errors import OracleError, UnknownName
from drivora_service.foreign_errors import exception_place
from drivora_service.oracles.built_in import default_oracles
from drivora_service.oracles.installed_oracles import InstalledOracle, traceback_of
from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_judging import LawOracle
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.oracles.oracle_descriptions import (
    SHARE,
    OracleDescription,
    ThresholdDescription,
    ViolatedBy,
    find_description,
)
from drivora_service.oracles.plugin import OracleObjective, OraclePlugin
from drivora_service.oracles.verdict import Oracle
from drivora_service.plugin_table import PluginTable

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_NAME = 60
"""Maximum length of a name in the database, characters."""


def law_description(law: Law) -> OracleDescription:
    """Returns the description of a law; what it measures is its robustness."""
    return OracleDescription(
        name=law.name,
        severity=law.severity,
        definition=law.description,
        unit=SHARE,
        violated_by=ViolatedBy.BELOW,
        thresholds=tuple(
            ThresholdDescription(
                name=parameter.name,
                unit=parameter.unit,
                meaning=parameter.meaning,
                source=law.source,
            )
            for parameter in law.parameters
        ),
        source=law.source,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class OracleEntry:
    """The description of an oracle.

    Attributes:
        description: One sentence.
        thresholds: By name, as JSON has them; SI units.
        package: Its package; "" for a built-in oracle and a law.
        formula: Its formula in signal temporal logic; "" unless it is a traffic law.
        file: The user's file that it is from; "" unless it is a law of the user.
        reason: Why it cannot be loaded, which prevents the judging of all runs; "" if it can.
    """

    name: str
    description: str
    thresholds: Mapping[str, Any] = field(default_factory=dict)
    package: str = ""
    formula: str = ""
    file: str = ""
    reason: str = ""


class OracleCatalogue:
    """Oracles by name.

    Packages provide them by entry points, found when the catalogue is made and loaded on first
    use. An oracle that cannot be loaded is not tried again.
    """

    def __init__(self, laws: Sequence[LawSource] = ()) -> None:
        """Finds all oracles.

        Args:
            laws: The user's law files.
        """
        self._built_in = {oracle.name: oracle for oracle in default_oracles()}
        self._table = PluginTable(
            kind="oracle",
            group="drivora_service.oracles",
            type_=OraclePlugin,
            built_in=[_plugin(oracle) for oracle in self._built_in.values()],
            error=partial(OracleError, cause="oracle_plugin"),
        )
        self._installed: dict[str, InstalledOracle | OracleError] = {}
        self._library = LawLibrary(laws, taken=(*self._built_in, *self._table.names()))
        self._laws = {
            name: LawOracle(law=self._library.law(name)) for name in self._library.names()
        }

    @property
    def library(self) -> LawLibrary:
        """The traffic laws."""
        return self._library

    @property
    def has_others(self) -> bool:
        """Whether there are oracles or laws that do not come with Drivora."""
        laws = (name for name in self._laws if not self._library.is_shipped(name))
        return bool(self._installed_names() or self._library.broken) or any(laws)

    def names(self) -> tuple[str, ...]:
        """Returns all names in the order of judging: built-in ones, laws, then packages' sorted.

        A law file that cannot be used is listed by the name of the file.
        """
        return (*self._built_in, *self._laws, *self._library.broken, *self._installed_names())

    def oracles(self) -> tuple[Oracle, ...]:
        """Returns all oracles in the order of judging.

        Raises:
            OracleError: As :meth:`laws` and :meth:`installed`.
        """
        return (*self._built_in.values(), *self.laws(), *self.load_installed())

    def laws(self) -> tuple[LawOracle, ...]:
        """Returns the traffic laws: shipped ones, then the user's.

        Raises:
            OracleError: A law file cannot be used.
        """
        for file in self._library.broken:
            raise self._make_law_error(file)
        return tuple(self._laws.values())

    def load_installed(self) -> tuple[InstalledOracle, ...]:
        """Returns the oracles of installed packages, sorted by name.

        Raises:
            OracleError: One of them cannot be loaded or made.
        """
        return tuple(self._load_oracle(name) for name in self._installed_names())

    def objectives(self) -> dict[str, tuple[OracleObjective, ...]]:
        """Returns the objectives of the oracles of installed packages, by oracle.

        Oracles that cannot be loaded, and those without objectives, are left out.
        """
        found = {}
        for name in self._installed_names():
            with contextlib.suppress(OracleError):
                self._load_oracle(name)
                found[name] = self._table.plugin(name).objectives
        return {name: objectives for name, objectives in found.items() if objectives}

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the package of an oracle with its version, or the hash of the user's law file.

        Empty for an oracle that comes with Drivora.
        """
        if name in self._laws and not self._library.is_shipped(name):
            law = self._library.law(name)
            return {f"laws/{law.file}": law.sha256[:16]}
        return self._table.versions(name)

    def oracle(self, name: str) -> Oracle:
        """Returns an oracle.

        Raises:
            UnknownName: If there is none of that name.
            OracleError: If an installed package's cannot be loaded or made, or it is the name of a
                law file that cannot be used.
        """
        if name in self._built_in:
            return self._built_in[name]
        if name in self._laws:
            return self._laws[name]
        if name in self._library.broken:
            raise self._make_law_error(name)
        if name not in self._table.names():
            raise UnknownName("oracle", name, self.names())
        return self._load_oracle(name)

    def entry(self, name: str) -> OracleEntry:
        """Returns the description of an oracle, with the reason if it cannot be loaded.

        Raises:
            UnknownName: If there is none of that name.
        """
        package = self._table.package(name)
        try:
            oracle = self.oracle(name)
        except OracleError as error:
            file = name if name in self._library.broken else ""
            return OracleEntry(
                name=name, description="", package=package, file=file, reason=str(error)
            )
        if isinstance(oracle, LawOracle):
            law = oracle.law
            return OracleEntry(
                name=name,
                description=law.description,
                thresholds=law.thresholds,
                formula=law.text,
                file="" if self._library.is_shipped(name) else law.file,
            )
        judge = oracle.oracle if isinstance(oracle, InstalledOracle) else oracle
        return OracleEntry(
            name=name,
            description=self._table.plugin(name).description,
            thresholds=_thresholds(judge),
            package=package,
        )

    def description(self, name: str) -> OracleDescription | None:
        """Returns what an oracle says about itself; ``None`` for one of a package."""
        if name in self._laws:
            return law_description(self._library.law(name))
        return find_description(name)

    def _make_law_error(self, file: str) -> OracleError:
        reason = self._library.broken[file].reason
        return OracleError(f"law file {file!r}: {reason}", cause="law_file")

    def _installed_names(self) -> tuple[str, ...]:
        return tuple(name for name in self._table.names() if name not in self._built_in)

    def _load_oracle(self, name: str) -> InstalledOracle:
        if name not in self._installed:
            try:
                self._installed[name] = self._make(name)
            except OracleError as error:
                self._installed[name] = error
        made = self._installed[name]
        if isinstance(made, OracleError):
            # Raising the same exception again would add frames to its traceback each time.
            raise OracleError(str(made), cause=made.cause, log=made.log) from made
        return made

    def _make(self, name: str) -> InstalledOracle:
        package = self._table.package(name)
        of = f"oracle {name!r} of the package {package!r}"
        refusal = partial(OracleError, cause="oracle_plugin")
        try:
            plugin = self._table.plugin(name)
        except OracleError as error:
            log = "" if error.__cause__ is None else traceback_of(error.__cause__)
            raise refusal(f"{of}: {error}", log=log) from error
        if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME:
            raise refusal(
                f"{of}: allowed are names in snake case of at most {_LONGEST_NAME} characters"
            )
        try:
            oracle: Any = plugin.create()
            judge, called = getattr(oracle, "judge", None), getattr(oracle, "name", None)
        except (Exception, SystemExit) as error:
            raise refusal(
                f"{of} raised {type(error).__name__} when it was made: {error}"
                f"{exception_place(error)}",
                log=traceback_of(error),
            ) from error
        if not callable(judge):
            raise refusal(f"{of} is a {type(oracle).__name__}, which has no method `judge`")
        if called != name:
            raise refusal(
                f"{of} has the name {called!r}; allowed: the name of its entry point, {name!r}"
            )
        objectives = tuple(one.name for one in plugin.objectives)
        for objective in objectives:
            if not _NAME.fullmatch(objective) or len(objective) > _LONGEST_NAME:
                raise refusal(
                    f"{of} has the objective {objective!r}; allowed are names in snake case of at "
                    f"most {_LONGEST_NAME} characters"
                )
        return InstalledOracle(name=name, package=package, oracle=oracle, objectives=objectives)


def _plugin(oracle: Oracle) -> OraclePlugin:
    summary = (inspect.getdoc(type(oracle)) or "").partition("\n\n")[0].replace("\n", " ")
    return OraclePlugin(name=oracle.name, description=summary, create=lambda: oracle)


def _thresholds(oracle: object) -> dict[str, Any]:
    """Returns the fields of a dataclass oracle; values that JSON cannot express as text."""
    if not is_dataclass(oracle):
        return {}
    return {
        threshold.name: to_jsonable_python(getattr(oracle, threshold.name, None), fallback=repr)
        for threshold in fields(oracle)
    }
