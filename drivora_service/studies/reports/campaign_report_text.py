"""The report of one campaign as Markdown."""

from __future__ import annotations

from collections.abc import Mapping

from drivora_service.campaigns.document.campaign import FeedbackMode
from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.markdown_text import code_span, escape_markdown, escape_prose, table
from drivora_service.oracles.verdicts.accountability import IN_WORDS, accountability
from drivora_service.oracles.verdicts.failure_facts import full_message
from drivora_service.short_values import short_value
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.missing_results import missing_words
from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.reports.campaign_report import CampaignReport, FailureGroup

_MOST_NUMBERS = 12


def report_markdown(
    report: CampaignReport, *, pictures: Mapping[int, str] | None = None, options: str = ""
) -> str:
    """Writes the report.

    Args:
        report: The campaign.
        pictures: Addresses of pictures by number of the evaluation.
        options: Additional options of the commands in the text, such as ``--data-dir DIR``.
    """
    record = report.record
    lines = [f"# Campaign {escape_markdown(record.name)}", ""]
    message = f": {escape_prose(record.message)}" if record.message else ""
    lines += [f"{code_span(record.id)}, {record.state}{message}"]
    if record.warnings:
        lines += ["", "## Warnings", ""]
        lines += [
            f"- {escape_prose(f'{one.message} {one.advice}')} See {code_span(one.page)}."
            for one in record.warnings
        ]
    lines += ["", "## Search", "", *table(("", ""), _make_search_rows(report))]
    lines += ["", "## Results", "", *table(("", ""), _outcome(report))]
    if report.note:
        lines += ["", f"Coverage and times are not known: {escape_prose(report.note)}"]
    if report.seeds:
        lines += ["", "## Seed scenarios", "", *_by_seed(report)]
    lines += ["", "## Failures", "", *_failures(report)]
    for group in report.groups:
        lines += ["", *_group(report, group, pictures or {}, options)]
    return "\n".join(lines) + "\n"


def _make_search_rows(report: CampaignReport) -> list[tuple[str, str]]:
    record, document = report.record, report.document
    tester = document.tester
    rows = [("method", tester.name)]
    if tester.parameters:
        rows.append(("its parameters", _plain(tester.parameters)))
    if tester.mutation:
        rows.append(("mutation in place of its own", tester.mutation))
    if tester.selection:
        rows.append(("selection in place of its own", tester.selection))
    if tester.start_from is not None:
        rows.append(("started from", tester.start_from.words))
    if document.feedback is not None:
        rows.append(("searched by, in place of its own objectives", document.feedback.words))
    if tester.feedback is FeedbackMode.SHUFFLED:
        rows.append(("feedback", "shuffled: it was told the results of other candidates"))
    space = {k: v for k, v in document.space.model_dump(mode="json").items() if v is not False}
    rows.append(("ADS", record.agent))
    if report.privileged:
        rows.append(("egos with full observations", ", ".join(report.privileged)))
    rows += [
        ("road network", f"{record.town} ({record.network_sha256[:8]})"),
        _seeds(document),
        ("space", ", ".join(f"{name} {_plain(value)}" for name, value in space.items())),
        ("failures", str(document.definition)),
        ("budget", f"{record.budget} simulations"),
        ("seed of the search", str(document.seed)),
        ("lookahead", str(document.lookahead)),
        ("versions", ", ".join(f"{k} {v}" for k, v in sorted(record.versions.items()))),
    ]
    return rows


def _seeds(document: CampaignDocument) -> tuple[str, str]:
    if document.scenario is None:
        return "seed scenarios", f"{len(document.seeds)}, in turns"
    scenario = document.scenario
    return "seed scenario", f"{len(scenario.ego_vehicles)} ego(s), seed {scenario.seed}"


def _by_seed(report: CampaignReport) -> list[str]:
    titles = (
        "seed scenario",
        "road network",
        "simulations",
        "with a failure",
        "at fault",
        "avoidable",
        "kinds",
        "first avoidable",
        "first failure",
    )
    rows = [
        (
            seed.name,
            seed.town,
            str(seed.simulations),
            str(seed.violating),
            str(seed.at_fault),
            str(seed.avoidable),
            str(seed.kinds),
            _evaluation(seed.first_avoidable),
            _evaluation(seed.first_failure),
        )
        for seed in report.seeds
    ]
    return table(titles, rows)


def _outcome(report: CampaignReport) -> list[tuple[str, str]]:
    counts, figures = report.record.counts, report.figures
    candidates = max(counts.evaluations, 1)
    rows = [
        ("simulations", f"{counts.simulations} of {report.record.budget}"),
        ("runs without a result", _missing(report)),
        ("of these by failures of the ADS itself", _count(counts.agent_failed)),
        (
            "invalid candidates",
            f"{counts.invalid} of {counts.evaluations} ({counts.invalid / candidates:.1%})",
        ),
        ("simulations with a failure", str(counts.violating)),
        ("of these with an ego at fault", str(counts.at_fault)),
        ("of these avoidable", _count(counts.avoidable)),
        ("simulations at fault, not avoidable", _count(counts.unavoidable)),
        ("simulations with undetermined fault", _count(counts.undetermined)),
        ("simulations not at fault, but avoidable", _count(counts.preventable)),
        ("work time", f"{report.record.active_s:.1f} s"),
    ]
    if report.record.seed_runs:
        rows.append(("seed scenarios as they are, outside the budget", _seed_runs(report)))
    return rows if figures is None else rows + _make_figure_rows(figures)


def _seed_runs(report: CampaignReport) -> str:
    runs = report.record.seed_runs
    failing = sum(bool(run.failures) or run.ads_failed for run in runs)
    return f"{failing} of {len(runs)} fail"


def _missing(report: CampaignReport) -> str:
    """Returns the number of runs without a result, with the most frequent reason."""
    _, _, reason = missing_words(report.record.counts.failed, report.missing).partition(": ")
    return str(report.record.counts.failed) + (f": {reason}" if reason else "")


def _make_figure_rows(figures: CampaignFigures) -> list[tuple[str, str]]:
    covered = figures.network_coverage
    return [
        ("simulations at fault, avoidability not measurable", str(figures.not_measurable)),
        ("simulations with violations whose oracles tell no fault", str(figures.not_judged)),
        ("simulations with violations at others' fault only", str(figures.not_at_fault)),
        ("first avoidable failure at fault", _first(figures.first_avoidable)),
        ("first failure", _first(figures.first_failure)),
        ("kinds of avoidable failures at fault", str(figures.avoidable_kinds)),
        ("kinds of failures", str(figures.kinds)),
        (
            "groups of similar failures",
            "not grouped" if figures.groups is None else str(figures.groups),
        ),
        ("situations with an avoidable failure at fault", str(figures.avoidable_situations)),
        ("situations with a failure", str(figures.situations)),
        ("coverage of the gene space", f"{figures.gene_coverage:.1%} of all pairs of levels"),
        (
            "coverage of the road network",
            "not known" if covered is None else f"{covered:.1%} of the drivable lanes",
        ),
        ("mutants drawn again, without an effect", _share(figures.redrawn_share)),
        ("candidates with their parent's run", _share(figures.unchanged_share)),
        (
            "coverage of traffic laws",
            "not known"
            if figures.law_coverage is None
            else f"{figures.law_coverage:.1%} of the ways to violate them",
        ),
        (
            "time of the method",
            f"{figures.own_s:.2f} s, {figures.own_share:.1%} of the {figures.simulation_s:.1f} s "
            "of simulation",
        ),
    ]


def _evaluation(number: int | None) -> str:
    return "none" if number is None else f"evaluation {number}"


def _first(simulation: int | None) -> str:
    return "none" if simulation is None else f"in simulation {simulation}"


def _share(share: float | None) -> str:
    return "not known" if share is None else f"{share:.1%}"


def _failures(report: CampaignReport) -> list[str]:
    if not report.groups:
        return ["No failures were found."]
    return table(
        (
            "kind",
            "group",
            "runs",
            "violations",
            "at fault",
            "avoidable",
            "confirmed",
            "flaky",
            "evaluations",
        ),
        [
            (
                _kind(group),
                _number(group),
                str(len({failure.evaluation for failure in group.failures})),
                str(len(group.failures)),
                str(group.at_fault),
                str(group.avoidable),
                str(group.count(Confirmation.CONFIRMED)),
                str(group.count(Confirmation.FLAKY)),
                _numbers(group),
            )
            for group in report.groups
        ],
    )


def _group(
    report: CampaignReport, group: FailureGroup, pictures: Mapping[int, str], options: str
) -> list[str]:
    failure, verdict = group.example, group.example.verdict
    number, campaign = failure.evaluation, report.record.id
    words = IN_WORDS[accountability(verdict)]
    fault = f", {words}" if words else ""
    when = "" if verdict.time is None else f" at {verdict.time:.1f} s"
    heading = _kind(group) + ("" if group.number is None else f", group {group.number}")
    file = f"{report.record.town}-{number}.json"
    extra = f" {options}" if options else ""
    lines = [
        f"### {escape_markdown(heading)}",
        "",
        f"Evaluation {number} ({failure.confirmation}): "
        + escape_markdown(f"{verdict.ego}{when}{fault}. {full_message(verdict)}"),
        "",
        "```sh",
        f"drivora campaign scenario {campaign} {number} --out {file}{extra}",
        f"drivora run {file}{extra}",
        f"drivora campaign show {campaign} --evaluation {number}{extra}",
        "```",
    ]
    if number in pictures:
        lines += ["", f"![Evaluation {number}]({pictures[number]})"]
    return lines


def _count(number: int | None) -> str:
    return "not told" if number is None else str(number)


def _kind(group: FailureGroup) -> str:
    return group.kind.replace("|", ", ")


def _number(group: FailureGroup) -> str:
    return "-" if group.number is None else str(group.number)


def _numbers(group: FailureGroup) -> str:
    numbers = list(dict.fromkeys(failure.evaluation for failure in group.failures))
    rest = len(numbers) - _MOST_NUMBERS
    shown = ", ".join(map(str, numbers[:_MOST_NUMBERS]))
    return f"{shown} and {rest} more" if rest > 0 else shown


def _plain(value: object) -> str:
    return value if isinstance(value, str) else short_value(value)
