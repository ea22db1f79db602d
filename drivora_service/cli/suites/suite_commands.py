"""``drivora suite``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import ConfigurationOption, id_of
from drivora_service.cli.terminal.options import (
    AgentParameterOption,
    DataDirOption,
    ServerOption,
    WorkersOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_file, write_result
from drivora_service.cli.terminal.output import JsonOption, note, print_json, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, FormKind, with_forms
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.cli.suites.suite_files import KnownNames
    from drivora_service.client import Client

app = typer.Typer(
    help="Runs suites of scenarios, and decides by a gate and a baseline.", no_args_is_help=True
)

_MAX_SEED = 2**31 - 1

SuiteArgument = Annotated[
    Path,
    typer.Argument(
        metavar="SUITE",
        help="A suite file, a folder with suite.yaml, scenario files, or a shipped suite: smoke.",
    ),
]
SelectOption = Annotated[
    str,
    typer.Option(
        "--select",
        metavar="EXPRESSION",
        help="Scenarios whose name or tags contain words: 'left and not (wet or fog)'.",
    ),
]
TagOption = Annotated[
    list[str] | None,
    typer.Option("--tag", metavar="TAG", help="Scenarios with this tag; may be repeated (any)."),
]
GateFileOption = Annotated[
    Path | None,
    typer.Option("--gate-file", metavar="FILE", help="The gate [default: no new failure]."),
]
BaselineOption = Annotated[
    Path | None,
    typer.Option(
        "--baseline", metavar="FILE", help="Accepted failures; without it every failure is new."
    ),
]
JunitOption = Annotated[
    Path | None, typer.Option("--junit", metavar="FILE", help="Write JUnit XML there.")
]
ReportOption = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write an HTML page there.")
]
SummaryOption = Annotated[
    Path | None, typer.Option("--summary", metavar="FILE", help="Write Markdown there.")
]
CsvOption = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Write a row for each run there.")
]
ResultsOption = Annotated[
    Path | None,
    typer.Option(
        "--results", metavar="FILE", help="Write the results there, for suite gate and baseline."
    ),
]
PicturesOption = Annotated[
    int, typer.Option("--pictures", min=0, max=200, help="Most pictures in the page.")
]


@app.command()
@with_forms
def run(
    suite: SuiteArgument,
    agent: Annotated[
        str, typer.Option(help="Agent of every ego, overrides the documented one.")
    ] = "",
    agent_parameter: AgentParameterOption = None,
    repetitions: Annotated[
        int | None,
        typer.Option(min=1, max=1000, help="Runs of each scenario, overrides the suite's number."),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=_MAX_SEED,
            help="Base of the runs' seeds [default: the scenarios' own seeds first].",
        ),
    ] = None,
    select: SelectOption = "",
    tag: TagOption = None,
    last_failed: Annotated[
        bool, typer.Option("--last-failed", help="Only what failed the last time.")
    ] = False,
    shard: Annotated[
        str,
        typer.Option(
            metavar="I/N",
            help="Run one of N parts; the gate then decides later, on the results of all of them.",
        ),
    ] = "",
    gate_file: GateFileOption = None,
    baseline: BaselineOption = None,
    junit: JunitOption = None,
    report: ReportOption = None,
    summary: SummaryOption = None,
    csv: CsvOption = None,
    results: ResultsOption = None,
    pictures: PicturesOption = 12,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Runs a suite and decides; exits with 1 if the gate fails, with 3 if a run was not judged."""
    from drivora_service.cli.suites.suite_decisions import (
        confirm_changes,
        decide_and_report,
        post_decision,
        print_and_exit,
    )
    from drivora_service.cli.suites.suite_reports import ReportFiles
    from drivora_service.suites.scenario_selection import read_shard

    files = ReportFiles(
        junit=junit, page=report, summary=summary, csv=csv, results=results, pictures=pictures
    )
    files.check()
    part = read_shard(shard) if shard else None
    with open_client(server, data_dir, works=True, makes_data=True, workers=workers) as client:
        from drivora_service.cli.suites.last_failed import read_last_failed as failed_before
        from drivora_service.cli.suites.last_failed import remember_failed
        from drivora_service.cli.suites.suite_files import read_suite_and_gate
        from drivora_service.cli.suites.suite_reports import failed_names, read_optional_baseline
        from drivora_service.cli.suites.suite_running import SuiteOrder, run_suite
        from drivora_service.suites.gate.baseline_definitions import check_definitions
        from drivora_service.suites.scenario_selection import choose
        from drivora_service.suites.suite_results import scenario_hash

        known = _names_of(client)
        read, gate = read_suite_and_gate(suite, gate_file, known)
        accepted = read_optional_baseline(baseline)
        chosen = choose(
            read.scenarios,
            expression=select,
            tags=tag or (),
            names=failed_before(suite, read.by_name) if last_failed else None,
            shard=part,
        )
        if accepted is not None:
            hashes = {one.name: scenario_hash(one.document) for one in chosen}
            check_definitions(accepted, hashes, read.by_name, gate.definition)
        order = SuiteOrder(
            agent=agent,
            agent_parameters=tuple(agent_parameter or ()),
            repetitions=repetitions or read.repetitions,
            seed=seed,
            where=location(server, data_dir),
            gate=gate.definition,
        )
        with run_progress(["runs"], total=len(chosen) * order.repetitions) as count:
            done = run_suite(client, read, chosen, order, shard=part, on_run=lambda: count("runs"))
        done = confirm_changes(client, read, done, order, gate, accepted)
        made = decide_and_report(client, done, read, gate, baseline, files)
        suite_run_id = post_decision(client, made) if part is None else ""
        # What was not run stays as it was, unless the suite no longer has it.
        not_run = read.by_name.keys() - done.scenarios.keys()
        remember_failed(suite, failed_names(made), not_run=not_run)
    print_and_exit(made, form, judges=part is None, suite_run_id=suite_run_id)


@app.command("gate")
def judge(
    suite: SuiteArgument,
    results: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS…", help="Files of suite run --results; shards are merged."),
    ],
    gate_file: GateFileOption = None,
    baseline: BaselineOption = None,
    junit: JunitOption = None,
    report: ReportOption = None,
    summary: SummaryOption = None,
    csv: CsvOption = None,
    merged: Annotated[
        Path | None, typer.Option("--merged", metavar="FILE", help="Write the merged results.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Decides on stored results, such as those of all shards; nothing is run."""
    from drivora_service.cli.suites.suite_decisions import decide_and_report, print_and_exit
    from drivora_service.cli.suites.suite_files import (
        names_of_installation,
        read_suite_and_gate,
        with_names_of,
    )
    from drivora_service.cli.suites.suite_reports import ReportFiles
    from drivora_service.suites.suite_checks import check_results, check_shards
    from drivora_service.suites.suite_results import merge_results, read_results

    files = ReportFiles(junit=junit, page=report, summary=summary, csv=csv, results=merged)
    files.check()
    done = merge_results([read_results(path) for path in results])
    known = with_names_of(done, names_of_installation())
    read, gate = read_suite_and_gate(suite, gate_file, known)
    check_shards(done, read)
    for remark in check_results(done, read):
        note(f"note: {remark}")
    made = decide_and_report(None, done, read, gate, baseline, files)
    print_and_exit(made, Form(FormKind.JSON) if as_json else TABLE, judges=True)


@app.command("baseline")
def accept(
    suite: SuiteArgument,
    results: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS…", help="Files of suite run --results; shards are merged."),
    ],
    baseline: Annotated[
        Path, typer.Option("--baseline", metavar="FILE", help="The baseline to write.")
    ],
    gate_file: GateFileOption = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show what would change, and write nothing.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Accepts what fails in results as the baseline, and shows what changes in it.

    Scenarios that these results do not have stay as they are.
    """
    from drivora_service.cli.suites.suite_files import (
        names_of_installation,
        read_suite_and_gate,
        with_names_of,
    )
    from drivora_service.suites.gate.baseline import (
        BaselineChange,
        baseline_changes,
    )
    from drivora_service.suites.gate.baseline_accepting import update_baseline
    from drivora_service.suites.gate.baseline_files import baseline_text, read_baseline
    from drivora_service.suites.suite_checks import check_judged, check_results
    from drivora_service.suites.suite_results import merge_results, read_results

    check_file(baseline)
    done = merge_results([read_results(path) for path in results])
    known = with_names_of(done, names_of_installation())
    read, gate = read_suite_and_gate(suite, gate_file, known)
    for remark in (*check_results(done, read), *check_judged(done)):
        note(f"note: {remark}")
    old = read_baseline(baseline) if baseline.is_file() else None
    new = update_baseline(done, read, gate, old)
    changes: list[BaselineChange] = list(baseline_changes(old, new))
    if not dry_run:
        write_result(baseline, baseline_text(new))
    if as_json:
        print_json(
            {
                "written": not dry_run,
                "changes": [
                    {"scenario": c.scenario, "what": c.what, "before": c.before, "after": c.after}
                    for c in changes
                ],
            }
        )
        return
    if changes:
        rows = [(c.scenario, c.what or "-", c.before, c.after) for c in changes]
        columns = ("scenario", "failure", "before", "now")
        print_table("", columns, rows, wrap=("failure",), cut=("scenario",))
    failures = sum(len(one.failures) for one in new.scenarios.values())
    verb = "would hold" if dry_run else "holds"
    say(
        f"{baseline} {verb} {failures} failures of {len(new.scenarios)} scenarios; "
        f"{len(changes)} changes"
    )


@app.command()
@with_forms
def history(
    suite: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of a suite that was run; none: all of them.")
    ] = "",
    agent: Annotated[str, typer.Option(metavar="NAME", help="Driven by this agent.")] = "",
    configuration: ConfigurationOption = "",
    runs: Annotated[int, typer.Option(min=1, max=200, help="Number of runs, the last ones.")] = 10,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows the last runs of a suite, and how its scenarios went; without a name, all suites."""
    with open_client(server, data_dir) as client:
        from drivora_service.cli.suites.suite_history import print_history, print_suites
        from drivora_service.shapes import adapter

        if not suite:
            suites = client.suites()
            if form.is_table:
                print_suites(suites.items)
            else:
                told = adapter(type(suites)).dump_python(suites, mode="json")
                form.print_content(told, told["items"], id_field="last.id")
            return
        configuration_id = id_of(client, configuration, IdKind.CONFIGURATION)
        found = client.suite_history(suite, agent=agent, configuration=configuration_id, runs=runs)
    if form.is_table:
        print_history(found)
    else:
        told = adapter(type(found)).dump_python(found, mode="json")
        form.print_content(told, told["runs"])


@app.command("list")
@with_forms
def list_scenarios(
    suite: SuiteArgument,
    select: SelectOption = "",
    tag: TagOption = None,
    form: Form = TABLE,
) -> None:
    """Lists the scenarios of a suite with their tags and their difficulty; nothing is run."""
    from drivora_service.cli.scenarios.file_problems import read_or_exit
    from drivora_service.cli.suites.suite_files import (
        NotedNames,
        describe_missing_oracles,
        names_of_installation,
        read_suite_path,
    )
    from drivora_service.cli.suites.suite_reports import print_scenarios
    from drivora_service.suites.scenario_selection import choose

    known = names_of_installation()
    oracles = NotedNames(known.oracles)
    names = replace(known, oracles=oracles)
    read = read_or_exit(suite, lambda: read_suite_path(suite, names))
    for remark in describe_missing_oracles(oracles.missing):
        note(remark)
    chosen = choose(read.scenarios, expression=select, tags=tag or ())
    if not form.is_table:
        form.print_content(
            [
                {
                    "scenario": one.name,
                    "town": one.document.map_region.town,
                    "tags": list(one.tags),
                    "known_failures": [known.reason for known in one.known_failures],
                    "failed_by": list(one.difficulty.failed_by) if one.difficulty else [],
                    "passed_by": list(one.difficulty.passed_by) if one.difficulty else [],
                }
                for one in chosen
            ],
            id_field="scenario",
        )
        return
    print_scenarios(list(chosen))


def _names_of(client: Client) -> KnownNames:
    """Returns the names that the application or service knows, whose packages may be others."""
    from drivora_service.cli.suites.suite_files import KnownNames
    from drivora_service.oracles.oracle_descriptions import MeasureKind

    metrics = client.describe_metrics().items
    return KnownNames(
        oracles=[oracle.name for oracle in client.oracles().items],
        metrics=[one.name for one in metrics if one.kind is MeasureKind.METRIC],
    )
