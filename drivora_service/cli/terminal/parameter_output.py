"""Parameters of plug-ins as commands print them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from drivora_service.cli.terminal.output import print_table

if TYPE_CHECKING:
    from drivora_service.api.schemas.catalogues import AgentParameter, TesterParameter


def print_parameters(parameters: Iterable[AgentParameter | TesterParameter]) -> None:
    """Prints a row a parameter."""
    from drivora_service.parameters import describe_allowed_values
    from drivora_service.short_values import short_value

    print_table(
        "",
        ("parameter", "default", "allowed", "description"),
        (
            (
                parameter.name,
                short_value(parameter.default),
                describe_allowed_values(parameter.values),
                parameter.description,
            )
            for parameter in parameters
        ),
        wrap=("allowed", "description"),
    )
