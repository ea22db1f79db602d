"""The results of a suite as one HTML file that needs no other and no network."""

from __future__ import annotations

import base64

from drivora_service.oracles.verdicts.accountability import IN_WORDS
from drivora_service.store.suites.suite_records import ScenarioState
from drivora_service.suites.gate.gate_decision import ClassifiedFailure
from drivora_service.suites.reports.suite_report import STATES_IN_WORDS, SuiteReport
from drivora_service.visible_text import visible_text

_TEMPLATE = "report.html.jinja"


def report_html(report: SuiteReport) -> str:
    """Returns the page; pictures are inside of it, and it runs no script."""
    # Imported here: only reports need it.
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("drivora_service.suites.reports", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_visible,
    )
    order = {state: rank for rank, state in enumerate(ScenarioState)}
    return environment.get_template(_TEMPLATE).render(
        report=report,
        decision=report.decision,
        rows=sorted(report.rows, key=lambda row: order[row.state]),
        facts=_facts,
        words=STATES_IN_WORDS,
        shown=[],
        pictures={run_id: _source(svg) for run_id, svg in report.pictures.items()},
    )


def _visible(value: object) -> object:
    """Returns a text with what acts made visible; Jinja escapes HTML in it afterwards."""
    if not isinstance(value, str):
        return value
    from markupsafe import Markup

    shown = visible_text(value, has_lines=True)
    return Markup(shown) if isinstance(value, Markup) else shown  # it was escaped


def _facts(one: ClassifiedFailure) -> str:
    """Returns how often a failure occurs, and what is known of its first violation, in a line."""
    parts = [one.change]
    if one.now is not None:
        parts.append(IN_WORDS[one.now.accountability])
        if one.now.time is not None:
            parts.append(f"at {one.now.time:.1f} s")
        if one.now.seeds:
            several = "s" if len(one.now.seeds) > 1 else ""
            parts.append(f"seed{several} {', '.join(map(str, one.now.seeds))}")
    return " · ".join(part for part in parts if part)


def _source(svg: bytes) -> str:
    return f"data:image/svg+xml;base64,{base64.b64encode(svg).decode()}"
