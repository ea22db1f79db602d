"""The catalogue of evaluators."""

from __future__ import annotations

from drivora_service.campaigns.evaluation.local_evaluator import LOCAL
from drivora_service.campaigns.evaluator import EvaluatorPlugin
from drivora_service.errors import CampaignError
from drivora_service.plugin_table import PluginTable

BUILT_IN = (LOCAL,)


def evaluator_plugins() -> PluginTable[EvaluatorPlugin]:
    """Returns the evaluators by name."""
    return PluginTable(
        kind="evaluator",
        group="drivora_service.evaluators",
        type_=EvaluatorPlugin,
        built_in=BUILT_IN,
        error=CampaignError,
    )
