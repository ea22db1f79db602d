"""``drivora demo``."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.output import note, number, print_table, say
from drivora_service.cli.terminal.run_progress import run_progress

if TYPE_CHECKING:
    from drivora_service.api.schemas.runs import Run
    from drivora_service.cli.service.demo_campaign import DemoCampaign
    from drivora_service.client import Client

_TOWN = "tee-town"


def demo(
    data_dir: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the demo.")] = Path(
        "demo-data"
    ),
    num: Annotated[int, typer.Option(min=1, max=200, help="Scenarios.")] = 12,
    town: Annotated[str, typer.Option(help="Road network of the scenarios.")] = _TOWN,
    simulations: Annotated[
        int, typer.Option(min=1, max=10_000, help="Budget of the campaign.")
    ] = 200,
    workers: Annotated[int, typer.Option(min=1, help="Worker processes.")] = 2,
) -> None:
    """Shows the whole process: a service judges generated scenarios, then searches for failures."""
    import time

    # Before the other imports, which take seconds in a new installation.
    note(f"generating {num} scenarios on {town}")
    from drivora_service.cli.application.command_connection import interrupt_on_sigterm
    from drivora_service.cli.application.service_process import own_token, run_service
    from drivora_service.cli.service.demo_campaign import run_demo_campaign
    from drivora_service.cli.service.first_verdict import print_first_verdict
    from drivora_service.cli.terminal.start_progress import start_progress
    from drivora_service.client import Client
    from drivora_service.compilation.machine_code_files import has_machine_code
    from drivora_service.runs.run_report import RunStatus
    from drivora_service.store.campaigns.campaign_records import CampaignState

    begun = time.monotonic()
    seeds = _write_seeds(data_dir, town, num)
    note(f"{len(seeds)} scenarios on {town} in {data_dir / 'seeds'}")

    def judge_first() -> None:
        if not has_machine_code():
            print_first_verdict(data_dir / "seeds" / f"{next(iter(seeds))}.json")

    with (
        interrupt_on_sigterm(),
        start_progress(),
        own_token(data_dir) as token,
        run_service(data_dir, workers=workers, meanwhile=judge_first) as url,
        Client(url, token=token) as client,
    ):
        note(f"the service runs at {url} with {workers} workers; a browser shows its page there")
        runs = _run_scenarios(client, seeds)
        _print_verdicts(runs)
        campaign = run_demo_campaign(client, data_dir, simulations=simulations)
        shown = max(runs, key=lambda run: run.violations or 0)
        picture = _draw(data_dir, shown)
        finished = sum(run.status is RunStatus.FINISHED for run in runs)
        record = campaign.campaign
        say(
            f"{finished} of {len(runs)} runs judged, and failures in {record.counts.violating} of "
            f"{record.simulations} simulations found, in {time.monotonic() - begun:.0f} s.\n"
        )
        _print_where(data_dir, shown, picture, campaign)
        _serve_at_a_terminal(f"{url}/campaigns/{record.id}")
    if finished < len(runs) or record.state is not CampaignState.FINISHED:
        raise typer.Exit(ExitCode.NOT_DONE)


def _write_seeds(data_dir: Path, town: str, num: int) -> dict[str, str]:
    """Generates scenarios with some traffic around the ego, and writes them to files.

    Returns:
        Their texts by the names of the files.
    """
    from drivora_service.cli.application.installation import network_catalogue, settings_for
    from drivora_service.scenario.documents import document_text
    from drivora_service.scenario.entities import BackgroundTrafficDocument
    from drivora_service.scenario.seed_generation import generate_seeds

    network = network_catalogue(settings_for(data_dir)).get(town)
    seeds = generate_seeds(
        network, count=num, min_length=150.0, max_length=400.0, seed=1, agent="idm"
    )
    folder = data_dir / "seeds"
    folder.mkdir(parents=True, exist_ok=True)
    texts = {}
    for number_, seed in enumerate(seeds, start=1):
        traffic = BackgroundTrafficDocument(count=8)
        text = document_text(seed.model_copy(update={"background_traffic": traffic}))
        name = f"{town}_{number_:04d}"
        (folder / f"{name}.json").write_text(text)
        texts[name] = text
    return texts


def _run_scenarios(client: Client, documents: Mapping[str, str]) -> list[Run]:
    """Has the service run scenarios, shows how far they are, and returns their runs in order."""
    posted = client.post_batch(list(documents.values()), labels=list(documents), name="demo")
    runs = []
    with run_progress(["runs"], total=posted.accepted) as count:
        for run in client.wait_for_batch(posted.batch.id):
            runs.append(run)
            count("runs")
    return sorted(runs, key=lambda run: run.item)


def _print_verdicts(runs: Sequence[Run]) -> None:
    from drivora_service.cli.runs.run_output import summary

    def row(run: Run) -> tuple[str, ...]:
        return (
            run.label,
            run.status.replace("_", " "),
            f"{run.sim_time_s:.1f}" if run.sim_time_s else "-",
            number(run.metrics.get("driving_score"), 2),
            summary(run),
        )

    print_table(
        "",
        ("scenario", "status", "sim time (s)", "driving score (%)", "violations"),
        map(row, runs),
        wrap=("violations",),
    )


def _draw(data_dir: Path, run: Run) -> Path | None:
    """Draws the run with the most violations."""
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.cli.terminal.trace_drawing import draw_trace
    from drivora_service.trace_settings import trace_places

    if not run.trace_sha256:
        return None
    settings = settings_for(data_dir)
    picture = data_dir / "run.svg"
    draw_trace(trace_places(settings).of_runs().path(run.id), settings, picture)
    return picture


def _print_where(data_dir: Path, run: Run, picture: Path | None, campaign: DemoCampaign) -> None:
    lines = [
        "Where to look:",
        f"  scenarios        {data_dir / 'seeds'}",
        f"  traces           {data_dir / 'traces'}",
        f"  service log      {data_dir / 'service.log'}",
        f"  the campaign     {campaign.file}",
        f"  its failures     {campaign.folder}",
    ]
    if picture is not None:
        lines.append(f"  a run, drawn     {picture}")
    lines += [f"  a failure, drawn {drawn}" for drawn in campaign.pictures]
    campaign_id = campaign.campaign.id
    lines += ["Go on:", f"  drivora campaign show {campaign_id} --data-dir {data_dir}"]
    for failure in campaign.failures[:1]:
        name = campaign.folder / f"{failure.evaluation:06d}"
        lines += [
            f"  drivora campaign show {campaign_id} --evaluation {failure.evaluation} "
            f"--data-dir {data_dir}",
            f"  drivora run {name}.json    simulates the first failure again",
            f"  drivora plot {name}.trace.parquet",
        ]
    lines += [
        f"  drivora plot {run.id} --data-dir {data_dir}",
        f"  drivora serve --data-dir {data_dir}    then open",
        f"    http://127.0.0.1:8000/campaigns/{campaign_id}",
        f"    http://127.0.0.1:8000/runs/{run.id}",
    ]
    say("\n".join(lines))


def _serve_at_a_terminal(page: str) -> None:
    """Keeps the service until Ctrl-C, for the reader at a terminal; programs go on at once."""
    import contextlib
    import signal

    if not sys.stdout.isatty():
        return
    say(f"\nThe page, until Ctrl-C ends the service:\n  {page}")
    with contextlib.suppress(KeyboardInterrupt):
        signal.pause()
