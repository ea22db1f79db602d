"""The results of a suite as JUnit XML, the form that CI systems read."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from drivora_service.store.suites.suite_records import ScenarioState
from drivora_service.suites.gate.failure_classes import FailureClass
from drivora_service.suites.gate.gate_decision import ClassifiedFailure
from drivora_service.suites.reports.suite_report import ScenarioRow, SuiteReport
from drivora_service.visible_text import visible_text

_GATE = "gate"
# XML 1.0 has no place for these characters, not even as references.
_NO_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit_xml(report: SuiteReport) -> bytes:
    """Returns the XML: a test case for each scenario, and one for the gate as a whole.

    A case has a failure if the gate fails for its scenario, and an error if a run was not judged
    and the gate does not ignore that. Accepted, flaky and known failures are skipped, with the
    reason and who accepted them: the baseline, by its file and ADS, or the author of the suite. So
    the XML has failures or errors exactly if the gate fails.
    """
    suite = ElementTree.Element("testsuite", name=_clean(report.results.suite))
    suite.set("timestamp", report.created_at.isoformat(timespec="seconds"))
    configuration = report.results.configuration
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in (
        ("agent", report.results.agent),
        *(("agent_parameter", one) for one in report.results.agent_parameters),
        ("configuration", "" if configuration is None else configuration.words),
        ("configuration_id", "" if configuration is None else configuration.id),
        ("shards", " ".join(report.results.shards)),
        ("baseline", report.baseline),
        ("baseline_of", report.baseline_subject),
        ("definition", report.decision.definition_sentence),
    ):
        if value:
            ElementTree.SubElement(properties, "property", name=name, value=_clean(value))
    for row in report.rows:
        _add_case(suite, row, report)
    _add_gate(suite, report)
    seconds = sum(row.seconds for row in report.rows)
    suite.set("time", f"{seconds:.3f}")
    suite.set("tests", str(len(suite.findall("testcase"))))
    for kind, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(kind, str(len(suite.findall(f"testcase/{tag}"))))
    root = ElementTree.Element("testsuites")
    root.append(suite)
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _add_case(suite: ElementTree.Element, row: ScenarioRow, report: SuiteReport) -> None:
    case = ElementTree.SubElement(suite, "testcase", name=_clean(row.name))
    case.set("classname", _clean(report.results.suite))
    case.set("time", f"{row.seconds:.3f}")
    failing = [one for one in row.failures if one.fails]
    if failing:
        message = "; ".join(_message(one, report) for one in failing)
        failure = ElementTree.SubElement(case, "failure", message=_clean(message))
        failure.set("type", _clean(failing[0].key.oracle))
        failure.text = _clean("\n".join(_details(one, report) for one in row.failures))
    elif row.state is ScenarioState.NOT_JUDGED:
        run = row.unfinished[0]
        tag = "skipped" if report.decision.ignores_unfinished else "error"
        error = ElementTree.SubElement(case, tag, type=_clean(run.cause or run.status))
        error.set("message", _clean(f"{run.status}: {run.message}"))
    elif row.failures:
        reasons = [_reason_to_skip(one, report) for one in row.failures]
        reasons += [_known_reason(reason) for reason in row.known]
        ElementTree.SubElement(case, "skipped", message=_clean("; ".join(reasons)))
    elif row.known:
        message = "; ".join(_known_reason(reason) for reason in row.known)
        ElementTree.SubElement(case, "skipped", message=_clean(message))
    if row.runs:
        lines = [
            f"seed {run.seed}: {run.status} {run.run_id} {run.trace_sha256[:12]}".rstrip()
            for run in row.runs
        ]
        ElementTree.SubElement(case, "system-out").text = _clean("\n".join(lines))


def _add_gate(suite: ElementTree.Element, report: SuiteReport) -> None:
    case = ElementTree.SubElement(suite, "testcase", name=_GATE, time="0.000")
    # Of a class of its own: a scenario may have the same name.
    case.set("classname", _clean(f"{report.results.suite}.{_GATE}"))
    if report.decision.fails:
        failure = ElementTree.SubElement(case, "failure", type=_GATE)
        failure.set("message", _clean(report.decision.sentence))
        failure.text = _clean("\n".join(report.decision.reasons))


def _reason_to_skip(one: ClassifiedFailure, report: SuiteReport) -> str:
    """Returns why the gate does not fail for a failure that occurs, and what it is."""
    if not report.decision.has_baseline:
        return f"the gate does not fail for it: {one.sentence}"
    where = report.baseline_words or "the baseline"
    if one.failure_class is FailureClass.SAME:
        return f"accepted in the baseline {where}: {one.sentence} It {one.change}."
    if one.failure_class is FailureClass.FLAKY:
        return f"flaky, against the baseline {where}: {one.sentence} It {one.change}."
    return (
        f"{one.failure_class}, for which the gate does not fail, against the baseline {where}: "
        f"{one.sentence} It {one.change}."
    )


def _known_reason(reason: str) -> str:
    return f"known failure, accepted by the author of the suite: {reason}"


def _message(one: ClassifiedFailure, report: SuiteReport) -> str:
    which = f"{one.failure_class}: " if report.decision.has_baseline else ""
    growth = f" It is {one.growth}." if one.growth else ""
    return f"{which}{one.sentence}{growth}"


def _details(one: ClassifiedFailure, report: SuiteReport) -> str:
    run = "" if one.now is None else f"\n  run {one.now.run_id}, seeds {list(one.now.seeds)}"
    which = f"{one.failure_class}: " if report.decision.has_baseline else ""
    return f"{one.key.oracle}: {which}{one.sentence} It {one.change}.{run}"


def _clean(text: str) -> str:
    """Returns a text with what acts made visible, and with what else XML cannot hold replaced."""
    return _NO_XML.sub("\ufffd", visible_text(text, has_lines=True))
