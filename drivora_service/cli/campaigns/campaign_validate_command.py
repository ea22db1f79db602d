"""``drivora campaign validate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, note, print_json, say

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import CampaignValidation


def validate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, as YAML or JSON.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Checks a campaign and names every problem with its place; nothing is run."""
    with open_client(server, data_dir) as client:
        import json

        from drivora_service.cli.campaigns.campaign_files import send_campaign
        from drivora_service.cli.campaigns.campaign_starts import resolve_campaign_start

        def send(content: dict[str, Any]) -> CampaignValidation:
            document = resolve_campaign_start(client, content, file.parent)
            return client.validate_campaign(json.dumps(document))

        valid = send_campaign(file, send)
    if as_json:
        print_json(valid.model_dump(mode="json"))
        return
    for remark in valid.notes:
        note(f"note: {remark}")
    say(f"{file}: valid; {valid.tester} on {valid.town}, {valid.genes} genes")
