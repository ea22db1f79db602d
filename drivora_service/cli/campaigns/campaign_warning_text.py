"""Warnings about campaigns and studies as commands print them."""

from __future__ import annotations

from drivora_service.cli.terminal.output import say
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning


def warning_line(warning: CampaignWarning) -> str:
    """Returns a warning in one line, with what to do and the page about it."""
    return f"warning: {warning.message} {warning.advice} See {warning.page}"


def print_warning(warning: CampaignWarning) -> None:
    """Prints a warning, with what to do and the page about it below."""
    say(f"  Warning: {warning.message}")
    say(f"    {warning.advice}")
    say(f"    See {warning.page}")
