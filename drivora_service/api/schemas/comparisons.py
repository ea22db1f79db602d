"""Figures of campaigns."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.shapes import Shape
from drivora_service.studies.campaign_figures import CampaignFigures


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures(Shape):
    """The figures of one campaign, finished or not.

    Attributes:
        figures: null where what it searched is not there any more.
        note: Why they are not known; empty if they are.
        privileged: Egos that saw more than the perception model lets through.
    """

    figures: CampaignFigures | None
    note: str
    privileged: tuple[str, ...] = ()
