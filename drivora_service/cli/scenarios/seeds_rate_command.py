"""``drivora seeds rate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.error_printing import say_error
from drivora_service.cli.terminal.interruption import say_interrupted
from drivora_service.cli.terminal.options import (
    DataDirOption,
    PostedCountsOption,
    ServerOption,
    WorkersOption,
    location,
    parse_counts,
)
from drivora_service.cli.terminal.output import JsonOption, note, print_prose, print_shape

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.cli.scenarios.seed_rating import SceneRates
    from drivora_service.client import Client

_MAX_SEED = 2**31 - 1


def rate(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="SEEDFILE…", help="Files or folders of seed scenarios."),
    ] = None,
    campaign: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Take seed scenarios, space, agent, counts and oracles from this campaign, in "
            "place of files.",
        ),
    ] = None,
    simulations: Annotated[
        int, typer.Option(min=1, max=100_000, help="Random scenarios of each seed scenario.")
    ] = 100,
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Space around the files' scenarios; see `campaign presets`."
        ),
    ] = "default",
    agent: Annotated[
        str, typer.Option(help="Agent of every ego, overrides the documented one.")
    ] = "",
    counts: PostedCountsOption = None,
    oracle: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Count only violations of this oracle; may be repeated [default: all but "
            "observations].",
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, max=_MAX_SEED, help="Seed of the random draws.")
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Tells how often random scenarios of a scene fail, before a campaign or a study on it.

    Runs random scenarios around each seed scenario, and that as it is, as a campaign of the tester
    `random` that is kept. Exits with 3 if that does not finish.
    """
    if bool(files) is (campaign is not None):
        raise typer.BadParameter(
            "give files of seed scenarios, or --campaign FILE, not both"
            if files
            else "no scene is given; name files of seed scenarios, or --campaign FILE",
            param_hint="SEEDFILE",
        )
    if campaign is not None and preset != "default":
        raise typer.BadParameter(
            "the space is that of the campaign; change it there", param_hint="--preset"
        )
    counted = parse_counts(counts)
    changes: dict[str, Any] = {}
    if agent:
        changes["agent"] = {"name": agent}
    if counted is not None:
        changes["counts"] = str(counted)
    if oracle:
        changes["oracles"] = list(dict.fromkeys(oracle))
    if seed is not None:
        changes["seed"] = seed
    with open_client(
        server, data_dir, works=True, makes_data=True, workers=workers, on_error=say_error
    ) as client:
        import json

        from drivora_service.cli.campaigns.campaign_files import send_campaign
        from drivora_service.cli.scenarios.file_problems import read_or_exit
        from drivora_service.cli.scenarios.seed_rating import random_campaign, scene_of_files

        given = campaign or Path(", ".join(str(file) for file in files or ()))

        def post(scene: dict[str, Any]) -> Campaign:
            content = random_campaign(
                scene, simulations=simulations, name=f"rate of {given}"[:200], **changes
            )
            return client.post_campaign(json.dumps(content))

        posted = (
            read_or_exit(given, lambda: post(scene_of_files(files or (), agent, preset)))
            if campaign is None
            else send_campaign(campaign, post)
        )
        rates = _rate(client, posted, given, server=server, data_dir=data_dir)
    if as_json:
        from drivora_service.cli.scenarios.seed_rating import SceneRates

        print_shape(SceneRates, rates)
    else:
        where = f"{rates.campaign_id} {location(server, data_dir)}".rstrip()
        _print_rates(rates, where)


def _rate(
    client: Client, posted: Campaign, given: Path, *, server: str, data_dir: Path | None
) -> SceneRates:
    from drivora_service.cli.campaigns.campaign_running import follow, pause_and_wait
    from drivora_service.cli.scenarios.seed_rating import (
        is_rated,
        rate_scenes,
        seeds_of,
    )

    for remark in posted.notes:
        note(f"note: {remark}")
    note(f"campaign {posted.id}")
    where = f"{posted.id} {location(server, data_dir)}".rstrip()
    names = [name or given.stem for name in seeds_of(posted.document)]
    try:
        done = follow(client, posted.id)
    except KeyboardInterrupt as error:
        if server:
            say_interrupted(
                f"the service continues its campaign; stop it with: drivora campaign pause {where}"
            )
        else:
            pause_and_wait(client, posted.id)
            say_interrupted(
                f"its campaign is paused; resume it with: drivora campaign resume {where}"
            )
        raise typer.Exit(ExitCode.INTERRUPTED) from error
    if not is_rated(done):
        note(f"the campaign is {done.state}{f': {done.message}' if done.message else ''}")
        note(f"look at it with: drivora campaign show {where}")
        raise typer.Exit(ExitCode.NOT_DONE)
    return rate_scenes(client, done, names)


def _print_rates(rates: SceneRates, where: str) -> None:
    from drivora_service.cli.scenarios.seed_rating import seed_words
    from drivora_service.cli.terminal.output import print_table
    from drivora_service.studies.failure_rates import FailureRate, percent

    def cells(of: FailureRate) -> tuple[str, ...]:
        share = "-" if of.rate is None else percent(of.rate)
        return (f"{of.failing}/{of.simulations}", share, f"{percent(of.low)} to {percent(of.high)}")

    rows = []
    for scene in rates.scenes:
        rows.append((scene.name, seed_words(scene.seed), "any", *cells(scene.total)))
        rows += [("", "", name, *cells(found)) for name, found in scene.oracles.items()]
    if len(rates.scenes) > 1:
        rows.append(("all", "", "any", *cells(rates.total)))
    print_table(
        "Random scenarios that fail",
        ("scene", "its seed", "oracle", "failing", "rate", "95 % interval"),
        rows,
        cut=("scene",),
        wrap=("its seed",),
    )
    for scene in rates.scenes:
        unjudged = (
            f" {scene.without_result} simulations have no result." if scene.without_result else ""
        )
        print_prose(f"{scene.name}: {scene.words}{unjudged}")
    print_prose(f"Failures are {rates.definition}.")
    note(f"look at them with: drivora campaign show {where}")
