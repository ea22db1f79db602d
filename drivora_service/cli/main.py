"""``drivora``: the command line.

The modules of the commands are light to import; a command imports its dependencies when it runs.
"""

from __future__ import annotations

from typing import Annotated, Any

import typer
import typer.main

from drivora_service.cli.batches import batches_commands, compare_command
from drivora_service.cli.campaigns import campaign_commands
from drivora_service.cli.catalogues import (
    agents_commands,
    laws_commands,
    metrics_commands,
    networks_commands,
    oracles_commands,
    testers_commands,
)
from drivora_service.cli.command_aliases import AliasedCommands
from drivora_service.cli.command_tree import complete_commands
from drivora_service.cli.doctor import doctor_command
from drivora_service.cli.exit_codes import EPILOG, ExitCode
from drivora_service.cli.failures import failures_commands, minimize_command
from drivora_service.cli.runs import (
    plot_command,
    rejudge_command,
    replay_command,
    run_command,
    runs_commands,
)
from drivora_service.cli.scenarios import (
    examples_command,
    schema_command,
    seeds_commands,
    validate_command,
)
from drivora_service.cli.service import (
    demo_command,
    export_command,
    serve_command,
    store_commands,
    tokens_commands,
)
from drivora_service.cli.studies import study_commands
from drivora_service.cli.suites import suite_commands
from drivora_service.cli.terminal.file_errors import describe_file_error
from drivora_service.cli.terminal.interruption import end_interrupted
from drivora_service.cli.terminal.output import fail, note, say
from drivora_service.cli.terminal.process_limits import describe_shortage
from drivora_service.cli.terminal.verbosity import (
    ADVICE,
    is_verbose,
    print_traceback,
    set_verbose,
)
from drivora_service.errors import (
    ConfigurationError,
    DrivoraError,
    NotFound,
    NothingStored,
    PluginError,
    UnknownName,
)


class Commands(typer.Typer):
    """All commands; turns Drivora's errors into messages and exit codes."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Runs the command that the command line names."""
        try:
            root = typer.main.get_command(self)
            complete_commands(root)
            return root(*args, **kwargs)
        except (ConfigurationError, UnknownName, NotFound, NothingStored) as error:
            _report(error)
            raise SystemExit(ExitCode.USAGE_ERROR) from error
        except DrivoraError as error:
            _report(error)
            raise SystemExit(ExitCode.NOT_DONE) from error
        except (OSError, MemoryError, RuntimeError) as error:
            file_message = describe_file_error(error) if isinstance(error, OSError) else ""
            message = file_message or describe_shortage(error)
            if not message:
                raise
            fail(message)
            print_traceback(error)
            raise SystemExit(ExitCode.NOT_DONE) from error
        except KeyboardInterrupt as error:
            end_interrupted()
            raise SystemExit(ExitCode.INTERRUPTED) from error
        except SystemExit as error:
            # The parser makes this of an interrupt that a command does not handle.
            if error.code == ExitCode.INTERRUPTED:
                end_interrupted()
            raise


def _report(error: DrivoraError) -> None:
    fail(str(error))
    if is_verbose():
        print_traceback(error)
    elif isinstance(error, PluginError) and error.log:
        note(ADVICE)


app = Commands(
    name="drivora",
    cls=AliasedCommands,
    help="Finds the scenarios in which autonomous driving systems fail, on SUMO.",
    epilog=EPILOG,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.command("run", epilog=EPILOG)(run_command.run)
app.command("compare", epilog=EPILOG)(compare_command.compare)
app.command("serve", epilog=EPILOG)(serve_command.serve)
app.command("validate", epilog=EPILOG)(validate_command.validate)
app.command("plot", epilog=EPILOG)(plot_command.plot)
app.command("minimize", epilog=EPILOG)(minimize_command.minimize)
app.command("rejudge", epilog=EPILOG)(rejudge_command.rejudge)
app.command("replay", epilog=EPILOG)(replay_command.replay)
app.command("export", epilog=EPILOG)(export_command.export)
app.command("schema", epilog=EPILOG)(schema_command.schema)
app.command("demo", epilog=EPILOG)(demo_command.demo)
app.command("doctor", epilog=EPILOG)(doctor_command.doctor)
app.command("examples", epilog=EPILOG)(examples_command.examples)
app.add_typer(runs_commands.app, name="runs", epilog=EPILOG)
app.add_typer(batches_commands.app, name="batches", epilog=EPILOG)
app.add_typer(campaign_commands.app, name="campaign", epilog=EPILOG)
app.add_typer(study_commands.app, name="study", epilog=EPILOG)
app.add_typer(failures_commands.app, name="failures", epilog=EPILOG)
app.add_typer(suite_commands.app, name="suite", epilog=EPILOG)
app.add_typer(seeds_commands.app, name="seeds", epilog=EPILOG)
app.add_typer(networks_commands.app, name="networks", epilog=EPILOG)
app.add_typer(agents_commands.app, name="agents", epilog=EPILOG)
app.add_typer(testers_commands.app, name="testers", epilog=EPILOG)
app.add_typer(oracles_commands.app, name="oracles", epilog=EPILOG)
app.add_typer(laws_commands.app, name="laws", epilog=EPILOG)
app.add_typer(metrics_commands.app, name="metrics", epilog=EPILOG)
app.add_typer(store_commands.app, name="store", epilog=EPILOG)
app.add_typer(tokens_commands.app, name="tokens", epilog=EPILOG)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        say(version("drivora"))
        raise typer.Exit


@app.callback()
def drivora(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
    _verbose: Annotated[
        bool,
        typer.Option(
            "--verbose",
            "-v",
            callback=set_verbose,
            expose_value=False,
            help="Print the tracebacks of errors.",
        ),
    ] = False,
) -> None:
    """Finds the scenarios in which autonomous driving systems fail, on SUMO."""
