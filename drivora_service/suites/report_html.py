"""The results of a suite as one HTML file that needs no other and no network."""

from __future__ import annotations

import base64

from drivora_service.suites.report import ScenarioState, SuiteReport

_TEMPLATE = "report.html.jinja"


def report_html(report: SuiteReport) -> str:
    """Returns the page; pictures are inside of it, and it runs no script."""
    # Imported here: only reports need it.
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("drivora_service.suites", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    order = {state: rank for rank, state in enumerate(ScenarioState)}
    return environment.get_template(_TEMPLATE).render(
        report=report,
        decision=report.decision,
        rows=sorted(report.rows, key=lambda row: order[row.state]),
        pictures={run_id: _source(svg) for run_id, svg in report.pictures.items()},
    )


def _source(svg: bytes) -> str:
    return f"data:image/svg+xml;base64,{base64.b64encode(svg).decode()}"
