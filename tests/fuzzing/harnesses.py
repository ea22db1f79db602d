"""All harnesses, by name."""

from __future__ import annotations

from tests.fuzzing.harness import Harness
from tests.fuzzing.parsers.campaigns import CAMPAIGN_BODY, CAMPAIGN_FILE
from tests.fuzzing.parsers.command_line import AGENT_PARAMETER, GATE
from tests.fuzzing.parsers.manifests import MANIFEST
from tests.fuzzing.parsers.networks import NETWORK
from tests.fuzzing.parsers.scenarios import (
    LEADERBOARD,
    ORIGINAL_TOOL,
    SCENARIO_JSON,
    SCENARIO_YAML,
)

HARNESSES: dict[str, Harness] = {
    harness.name: harness
    for harness in (
        SCENARIO_JSON,
        SCENARIO_YAML,
        ORIGINAL_TOOL,
        LEADERBOARD,
        NETWORK,
        CAMPAIGN_BODY,
        CAMPAIGN_FILE,
        MANIFEST,
        AGENT_PARAMETER,
        GATE,
    )
}
