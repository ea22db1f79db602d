"""Options that several commands share."""

from __future__ import annotations

import shlex
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from drivora_service.known_names import advise_name

if TYPE_CHECKING:
    from drivora_service.oracles.verdicts.failure_definition import Counted

_COUNTS = (
    "Violations that are failures: accountable, preventable (also those of others that a careful "
    "driver avoids), at_fault (also unavoidable ones), possibly_at_fault, or any"
)

ServerOption = Annotated[
    str,
    typer.Option(
        "--server",
        metavar="URL",
        envvar="DRIVORA_SERVER",
        help="Ask the service at URL (token: DRIVORA_TOKEN) instead of working in this process.",
    ),
]
EqualTimeOption = Annotated[
    bool,
    typer.Option(
        "--equal-time",
        help="Compare the results of each campaign after the time that the shortest one took.",
    ),
]
DataDirOption = Annotated[
    Path | None,
    typer.Option(
        "--data-dir",
        metavar="DIR",
        help="Folder of the database, traces and imported networks [default: drivora-data].",
    ),
]
AgentParameterOption = Annotated[
    list[str] | None,
    typer.Option(
        "--agent-parameter",
        metavar="NAME=VALUE",
        help="Set a parameter of every ego's agent, or of one's: EGO:NAME=VALUE. Repeatable; a "
        "value that is no JSON is text.",
    ),
]
CountsOption = Annotated[
    str | None,
    typer.Option(
        "--counts",
        metavar="WORD",
        help=f"{_COUNTS} [default: as defined where the runs were posted].",
    ),
]
PostedCountsOption = Annotated[
    str | None,
    typer.Option(
        "--counts",
        metavar="WORD",
        help=f"{_COUNTS} [default: accountable].",
    ),
]
GateOracleOption = Annotated[
    list[str] | None,
    typer.Option(
        "--gate-oracle",
        metavar="ORACLE[=RUNS]",
        help="Exit with 1 if ORACLE was violated in more than RUNS runs [default: 0]; may be "
        "repeated; oracles that are not named do not count then, and a failure of the ADS itself "
        "always does.",
    ),
]
WorkersOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Worker processes, on a Ray cluster of each node [default: one a core]; not with "
        "--server.",
    ),
]
ExecutorOption = Annotated[
    str | None,
    typer.Option(
        "--executor",
        metavar="NAME",
        help="Where runs are performed: local, or ray, the nodes of a Ray cluster "
        "[default: local].",
    ),
]
RayAddressOption = Annotated[
    str | None,
    typer.Option(
        "--ray-address",
        metavar="ADDRESS",
        help="The Ray cluster, HOST:PORT [default: auto, the one that this machine belongs to].",
    ),
]


_Word = TypeVar("_Word", bound=StrEnum)


def parse_counts(word: str | None) -> Counted | None:
    """Reads ``--counts``; ``None`` if it is not given.

    Raises:
        typer.BadParameter: It is no such word.
    """
    # Imported here: commands that do not count need not load the verdicts.
    from drivora_service.oracles.verdicts.failure_definition import Counted

    return None if word is None else parse_choice(Counted, word, "--counts")


def parse_choice(kind: type[_Word], word: str, option: str) -> _Word:
    """Reads one of a few words.

    Args:
        kind: The words.
        word: The given one.
        option: Name of the option.

    Raises:
        typer.BadParameter: It is none of them.
    """
    try:
        return kind(word)
    except ValueError as error:
        raise typer.BadParameter(
            f"{word!r}; {advise_name(word, kind)}", param_hint=option
        ) from error


def location(server: str, data_dir: Path | None) -> str:
    """Returns the options with which another command asks the same service or data folder.

    A data folder of the environment needs none.
    """
    if server:
        return f"--server {shlex.quote(server)}"
    return "" if data_dir is None else f"--data-dir {shlex.quote(str(data_dir))}"
