"""Examples of every command, which its ``--help`` ends with."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

EXAMPLES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "run": (
            "drivora run scenarios/ --agent idm",
            "drivora run crossing.json --out results --gate",
        ),
        "compare": (
            "drivora compare 'idm, May' 'idm, June'",
            "drivora compare scenarios/ --agent-a idm --agent-b pdm-closed",
        ),
        "serve": ("drivora serve --port 8001 --workers 4",),
        "validate": ("drivora validate scenarios/ crossing.json",),
        "plot": ("drivora plot 01a2276b95aa5d34def82775 --out run.svg",),
        "minimize": ("drivora minimize 01a2276b95aa5d34def82775 --oracle collision",),
        "rejudge": ("drivora rejudge results/", "drivora rejudge 01a2276b95aa5d34def82775"),
        "replay": (
            "drivora replay 01a2276b95aa5d34def82775",
            "drivora replay --campaign 01a22774cd2687ba3ce38413",
        ),
        "export": (
            "drivora export --out tables",
            "drivora export --out tables --campaign 01a22774cd2687ba3ce38413",
        ),
        "schema": ("drivora schema --check",),
        "demo": ("drivora demo", "drivora demo --town roundabout --num 6"),
        "examples": ("drivora examples --out examples",),
        "runs list": ("drivora runs list --violated --limit 10", "drivora runs list --town rural"),
        "runs show": ("drivora runs show 01a2276b95aa5d34def82775",),
        "runs scenario": ("drivora runs scenario 01a2276b95aa5d34def82775 --out again.json",),
        "campaign run": (
            "drivora campaign run campaign.yaml --out failures",
            "drivora campaign run campaign.yaml --gate",
        ),
        "campaign resume": ("drivora campaign resume 01a22774cd2687ba3ce38413",),
        "campaign list": ("drivora campaign list --limit 10",),
        "campaign show": (
            "drivora campaign show 01a22774cd2687ba3ce38413",
            "drivora campaign show 01a22774cd2687ba3ce38413 --evaluation 17",
        ),
        "campaign scenario": (
            "drivora campaign scenario 01a22774cd2687ba3ce38413 17 --out found.json",
        ),
        "campaign pause": ("drivora campaign pause 01a22774cd2687ba3ce38413",),
        "campaign cancel": ("drivora campaign cancel 01a22774cd2687ba3ce38413",),
        "campaign compare": ("drivora campaign compare 'random-*' 'samota-*' --out compared",),
        "campaign report": ("drivora campaign report 01a22774cd2687ba3ce38413 --out report.md",),
        "campaign export": (
            "drivora campaign export 01a22774cd2687ba3ce38413 --suite suites/found",
        ),
        "campaign presets": ("drivora campaign presets",),
        "study run": ("drivora study run study.yaml --workers 4",),
        "study resume": ("drivora study resume 01a22775493c7d2c5cf537fe",),
        "study list": ("drivora study list --limit 10",),
        "study show": ("drivora study show 01a22775493c7d2c5cf537fe",),
        "study pause": ("drivora study pause 01a22775493c7d2c5cf537fe",),
        "study cancel": ("drivora study cancel 01a22775493c7d2c5cf537fe",),
        "study compare": (
            "drivora study compare 01a22775493c7d2c5cf537fe --baseline-method random",
        ),
        "study export": ("drivora study export 01a22775493c7d2c5cf537fe --out exported",),
        "failures list": ("drivora failures list --oracle collision --town rural",),
        "failures groups": ("drivora failures groups --status new",),
        "failures show": ("drivora failures show 12",),
        "failures decide": (
            "drivora failures decide 12 --status known --note 'waits for the new planner'",
        ),
        "failures merge": ("drivora failures merge 12 15 18",),
        "failures split": ("drivora failures split 12 --failure 340 --label 'at the crossing'",),
        "suite run": (
            "drivora suite run smoke --agent idm",
            "drivora suite run suites/city --agent acme --junit junit.xml --report report",
        ),
        "suite gate": ("drivora suite gate suites/city results.json --summary summary.md",),
        "suite baseline": ("drivora suite baseline suites/city results.json --baseline base.json",),
        "suite history": ("drivora suite history smoke --agent idm",),
        "suite list": ("drivora suite list smoke --tag collision",),
        "seeds generate": ("drivora seeds generate --town rural --num 20 --out seeds",),
        "seeds import": ("drivora seeds import routes.xml --agent idm --out seeds",),
        "networks list": ("drivora networks list",),
        "networks show": ("drivora networks show tee-town",),
        "networks import": ("drivora networks import town.osm --name my-town",),
        "agents benchmark": ("drivora agents benchmark idm pdm-closed --runs 2 --out cards",),
        "agents list": ("drivora agents list",),
        "agents show": ("drivora agents show idm",),
        "agents install": ("drivora agents install dilu",),
        "testers list": ("drivora testers list",),
        "testers show": ("drivora testers show samota",),
        "oracles list": ("drivora oracles list",),
        "oracles show": ("drivora oracles show tailgating",),
        "laws list": ("drivora laws list",),
        "laws check": ("drivora laws check laws.yaml",),
        "store migrate": ("drivora store migrate",),
        "store backup": ("drivora store backup backup-monday",),
        "store verify": ("drivora store verify --hashes",),
        "store prune": ("drivora store prune --older-than 30 --keep-violated",),
        "tokens create": ("drivora tokens create ci --scope submit",),
        "tokens list": ("drivora tokens list",),
        "tokens revoke": ("drivora tokens revoke ci",),
    }
)
"""Command lines by the words of their command. Ids stand for those that commands print."""
