"""``drivora``: the command line.

The modules of the commands are light to import; a command imports its dependencies when it runs.
"""

from __future__ import annotations

from typing import Annotated, Any

import typer

from drivora_service.cli.commands import (
    agents,
    campaign,
    compare,
    demo,
    examples,
    export,
    failures,
    laws,
    minimize,
    networks,
    oracles,
    plot,
    rejudge,
    replay,
    run,
    runs,
    schema,
    seeds,
    serve,
    store,
    study,
    suite,
    testers,
    tokens,
    validate,
)
from drivora_service.cli.exit_codes import EPILOG, ExitCode
from drivora_service.cli.output import fail, note
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
            return super().__call__(*args, **kwargs)
        except (ConfigurationError, UnknownName, NotFound, NothingStored) as error:
            fail(str(error))
            raise SystemExit(ExitCode.USAGE_ERROR) from error
        except DrivoraError as error:
            fail(str(error))
            if isinstance(error, PluginError) and error.log:
                note(error.log)
            raise SystemExit(ExitCode.NOT_DONE) from error


app = Commands(
    name="drivora",
    help="Finds the scenarios in which autonomous driving systems fail, on SUMO.",
    epilog=EPILOG,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.command("run", epilog=EPILOG)(run.run)
app.command("compare", epilog=EPILOG)(compare.compare)
app.command("serve", epilog=EPILOG)(serve.serve)
app.command("validate", epilog=EPILOG)(validate.validate)
app.command("plot", epilog=EPILOG)(plot.plot)
app.command("minimize", epilog=EPILOG)(minimize.minimize)
app.command("rejudge", epilog=EPILOG)(rejudge.rejudge)
app.command("replay", epilog=EPILOG)(replay.replay)
app.command("export", epilog=EPILOG)(export.export)
app.command("schema", epilog=EPILOG)(schema.schema)
app.command("demo", epilog=EPILOG)(demo.demo)
app.command("examples", epilog=EPILOG)(examples.examples)
app.add_typer(runs.app, name="runs", epilog=EPILOG)
app.add_typer(campaign.app, name="campaign", epilog=EPILOG)
app.add_typer(study.app, name="study", epilog=EPILOG)
app.add_typer(failures.app, name="failures", epilog=EPILOG)
app.add_typer(suite.app, name="suite", epilog=EPILOG)
app.add_typer(seeds.app, name="seeds", epilog=EPILOG)
app.add_typer(networks.app, name="networks", epilog=EPILOG)
app.add_typer(agents.app, name="agents", epilog=EPILOG)
app.add_typer(testers.app, name="testers", epilog=EPILOG)
app.add_typer(oracles.app, name="oracles", epilog=EPILOG)
app.add_typer(laws.app, name="laws", epilog=EPILOG)
app.add_typer(store.app, name="store", epilog=EPILOG)
app.add_typer(tokens.app, name="tokens", epilog=EPILOG)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("drivora"))
        raise typer.Exit


@app.callback()
def drivora(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Finds the scenarios in which autonomous driving systems fail, on SUMO."""
