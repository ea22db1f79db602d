"""The keys of campaigns on the page of the commands, and those that they print."""

from __future__ import annotations

import re
from pathlib import Path

from drivora_service.api.schemas.campaigns import Campaign
from drivora_service.shapes import adapter
from drivora_service.store.campaigns.campaign_records import CampaignSummary

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "cli.md"
OF_THE_COMMAND = {"failures"}
"""What `campaign show` adds to the campaign of the API."""


def documented() -> list[str]:
    """The keys of the table, in its order."""
    _, _, rest = PAGE.read_text().partition("Scripts may rely on these keys of a campaign.")
    table, _, _ = rest.partition("\n## ")
    rows = re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE)
    return [key for row in rows for key in re.findall(r"`(\w+)`", row)]


def printed(kind: type) -> set[str]:
    schema = adapter(kind).json_schema(mode="serialization")
    return set(schema.get("properties") or schema["$defs"][kind.__name__]["properties"])


def test_the_page_has_the_keys_that_commands_print() -> None:
    keys = documented()
    assert len(keys) == len(set(keys))
    listed = keys[: keys.index("revision") + 1]
    assert set(listed) == printed(CampaignSummary)
    assert set(keys) - OF_THE_COMMAND == printed(Campaign)
