"""``drivora compare``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import (
    CountsOption,
    DataDirOption,
    ServerOption,
    WorkersOption,
    location,
    parse_choice,
    parse_counts,
)
from drivora_service.cli.terminal.out_option import check_folder, convert_write_errors
from drivora_service.cli.terminal.output import JsonOption, note, print_shape
from drivora_service.errors import ConfigurationError

if TYPE_CHECKING:
    from drivora_service.cli.batches.pair_running import SideOptions
    from drivora_service.client import Client
    from drivora_service.suites.paired.batch_comparison import BatchComparison

_UNFINISHED = ("agent", "all", "none")
_MAX_SEED = 2**31 - 1


def compare(
    wanted: Annotated[
        list[str],
        typer.Argument(
            metavar="BATCH BATCH|SCENARIO…",
            help="Two batches, A and B (id, first digits of it, name: the newest of it, or "
            "latest); or, with options of A or B, the scenarios to run as both.",
        ),
    ],
    counts: CountsOption = None,
    unfinished: Annotated[
        str,
        typer.Option(
            metavar="|".join(_UNFINISHED),
            help="Runs without a judgement that are failures: those that the ADS ended, all, or "
            "none.",
        ),
    ] = "agent",
    oracle: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Count violations of this oracle only, observations included; may be repeated "
            "[default: as defined where the runs were posted].",
        ),
    ] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Metric to compare; may be repeated [default: all]."),
    ] = None,
    agent_a: Annotated[str, typer.Option(metavar="NAME", help="Agent of every ego in A.")] = "",
    agent_b: Annotated[str, typer.Option(metavar="NAME", help="Agent of every ego in B.")] = "",
    parameter_a: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Parameter of the agents in A; repeatable."),
    ] = None,
    parameter_b: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Parameter of the agents in B; repeatable."),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=_MAX_SEED, help="Seed of the scenarios that are run."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write tables (Markdown, CSV) there.")
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compares two ADSs or two versions on the same scenarios: failures, metrics, and where.

    Exits with 3 if no run has a counterpart, or a scenario could not be run.
    """
    from drivora_service.suites.paired.failure_rules import Unfinished

    unjudged = parse_choice(Unfinished, unfinished, "--unfinished")
    counted = parse_counts(counts)
    check_folder(out)
    runs_both = bool(agent_a or agent_b or parameter_a or parameter_b)
    if not runs_both and (workers is not None or seed is not None):
        raise ConfigurationError(
            "--workers and --seed are for scenarios that are run: name the agents of A and B "
            "(--agent-a, --agent-b, --parameter-a, --parameter-b), or leave them out"
        )
    if not runs_both and len(wanted) != 2:
        raise ConfigurationError(
            f"found {len(wanted)} batches; allowed: two, as ids or names. To run scenarios as A "
            "and B, name their agents: --agent-a, --agent-b, --parameter-a, --parameter-b"
        )
    complete = True
    with open_client(
        server, data_dir, works=runs_both, makes_data=runs_both, workers=workers
    ) as client:
        if runs_both:
            from drivora_service.cli.batches.pair_running import SideOptions

            wanted, complete = _run_both(
                client,
                [Path(path) for path in wanted],
                SideOptions(agent=agent_a, parameters=tuple(parameter_a or ())),
                SideOptions(agent=agent_b, parameters=tuple(parameter_b or ())),
                seed=seed,
                where=location(server, data_dir),
            )
        comparison = client.compare_batches(
            *wanted,
            counts=counted,
            unfinished=unjudged,
            oracles=tuple(oracle or ()),
            metrics=tuple(dict.fromkeys(metric or ())),
        )
    _show(comparison, out, as_json=as_json)
    if not comparison.pairs or not complete:
        raise typer.Exit(ExitCode.NOT_DONE)


def _show(comparison: BatchComparison, out: Path | None, *, as_json: bool) -> None:
    if as_json:
        print_shape(type(comparison), comparison)
    else:
        from drivora_service.cli.batches.batch_output import print_batch_comparison

        print_batch_comparison(comparison)
    if out is not None:
        from drivora_service.suites.paired.batch_comparison_files import write_batch_comparison

        with convert_write_errors(out):
            written = write_batch_comparison(comparison, out)
        for path in written:
            note(str(path))


def _run_both(
    client: Client,
    scenarios: Sequence[Path],
    a: SideOptions,
    b: SideOptions,
    *,
    seed: int | None,
    where: str,
) -> tuple[list[str], bool]:
    """Runs scenarios as A and as B; returns the batches, and whether all could be run."""
    from drivora_service.cli.batches.pair_running import run_as_both

    both = run_as_both(client, scenarios, a, b, seed=seed, where=where)
    for line in both.problems:
        note(line)
    return [both.a, both.b], not both.problems
