"""Parameters of plug-ins as commands print them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from drivora_service.cli.output import print_table

if TYPE_CHECKING:
    from drivora_service.parameters import ParameterDescription


def parameter_contents(parameters: Iterable[ParameterDescription]) -> list[dict[str, Any]]:
    """Returns the printed form of parameters, which is that of the HTTP API."""
    return [
        {
            "name": parameter.name,
            "default": parameter.default,
            "values": dict(parameter.schema),
            "description": parameter.description,
        }
        for parameter in parameters
    ]


def print_parameters(parameters: Iterable[dict[str, Any]]) -> None:
    """Prints a row a parameter."""
    from drivora_service.parameters import allowed_values

    print_table(
        "",
        ("parameter", "default", "allowed", "description"),
        (
            (
                parameter["name"],
                json.dumps(parameter["default"]),
                allowed_values(parameter["values"]),
                parameter["description"],
            )
            for parameter in parameters
        ),
        wrap=("allowed", "description"),
    )
