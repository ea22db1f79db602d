"""Runs, failures and campaigns know by which definition a violation is a failure.

What a run missed only because another violation ended its part is no violation of its own any more,
and violations at the fault of others that a careful driver avoids have a degree of their own. Both
follow from stored reports. Campaigns counted whatever was not known to be another's fault: their
documents say so now, so that they go on as they began.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

import sqlalchemy as sa
from alembic import op

from drivora_service.store.runs.facets import Facet, facet_key

revision = "0022"
down_revision = "0021"
branch_labels = None
depends_on = None

_CHUNK = 500
_GROUPED = (
    "group_name",
    "group_seq",
    "accountability",
    "campaign_seq",
    "town",
    "oracle",
    "agent",
    "at_fault",
    "confirmation",
    "batch_seq",
    "found_at",
    "configuration_id",
    "is_counted",
    "is_violation",
)
_ENDS = ("collision", "stuck", "route_deviation")
_DEGREES = (
    "avoidable",
    "not_measurable",
    "unavoidable",
    "undetermined",
    "not_judged",
    "preventable",
    "not_at_fault",
)
_ACCOUNTABLE = ("avoidable", "not_measurable", "not_judged")
_FACET = ("agent", "town", "status", "violated", "accountability", "configuration")


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(one) for one in columns))


_RUNS = _table(
    "runs", "seq", "item", "batch_seq", "status", "violations", "accountability", "facet",
    "failures", "definition",
)  # fmt: skip
_REPORTS = _table("reports", "run_seq", "body")
_VERDICTS = _table("verdicts", "seq", "run_seq", "oracle", "outcome", "accountability", "facet")
_FOUND = _table(
    "found_failures", "seq", "run_seq", "campaign_seq", "number", "place", "accountability",
    "is_counted", "is_violation",
)  # fmt: skip
_CAMPAIGNS = _table("campaigns", "seq", "batch_id", "document")
_STUDIES = _table("studies", "seq", "document")
_BATCHES = _table("batches", "seq", "id")
_FAILURES = _table("failures", "campaign_seq", "number", "place", "oracle", "verdict")
_FACETS = _table("facets", "key", *_FACET, "configuration_id", "failing", "runs")
_BATCH_FACETS = _table("batch_facets", "batch_seq", "facet", "runs")


def upgrade() -> None:
    empty = sa.text("''")
    op.add_column("runs", sa.Column("definition", sa.Text(), server_default=empty, nullable=False))
    op.add_column("runs", sa.Column("failures", sa.Integer(), nullable=True))
    op.add_column("facets", sa.Column("failing", sa.Boolean(), nullable=True))
    for name in ("is_counted", "is_violation"):
        op.add_column(
            "found_failures",
            sa.Column(name, sa.Boolean(), server_default=sa.true(), nullable=False),
        )
    op.add_column("campaigns", sa.Column("preventable", sa.Integer(), nullable=True))
    connection = op.get_bind()
    _judge_again(connection)
    _count_failures(connection)
    _define_campaigns(connection)
    _mark_what_only_campaigns_count(connection)
    _fill_facets(connection)
    op.drop_index("ix_found_failures_group", table_name="found_failures")
    op.create_index("ix_found_failures_group", "found_failures", list(_GROUPED))


def _judge_again(connection: sa.Connection) -> None:
    """Reads the reports of the runs whose violations count otherwise now."""
    concerned = sa.or_(
        _VERDICTS.c.accountability == "not_at_fault", _VERDICTS.c.oracle == "destination"
    )
    query = sa.select(_VERDICTS.c.run_seq).where(_VERDICTS.c.outcome == "violated", concerned)
    runs = connection.execute(query.distinct().order_by(_VERDICTS.c.run_seq)).scalars().all()
    for start in range(0, len(runs), _CHUNK):
        chunk = runs[start : start + _CHUNK]
        reports = sa.select(_REPORTS.c.run_seq, _REPORTS.c.body)
        for run_seq, body in connection.execute(reports.where(_REPORTS.c.run_seq.in_(chunk))).all():
            _judge_run_again(connection, run_seq, json.loads(body))


def _judge_run_again(connection: sa.Connection, run_seq: int, report: Mapping[str, Any]) -> None:
    notable = [
        (place, verdict)
        for place, verdict in enumerate(report.get("verdicts") or ())
        if verdict["outcome"] in ("violated", "not_measurable")
    ]
    query = sa.select(_VERDICTS.c.seq).where(_VERDICTS.c.run_seq == run_seq)
    stored = connection.execute(query.order_by(_VERDICTS.c.seq)).scalars().all()
    kept = []
    for (place, verdict), seq in zip(notable, stored, strict=False):
        if verdict["outcome"] != "violated":
            continue
        degree = _degree(verdict)
        found = _FOUND.c.run_seq == run_seq, _FOUND.c.place == place
        if degree == "preventable":
            same = _VERDICTS.update().where(_VERDICTS.c.seq == seq)
            connection.execute(same.values(accountability=degree))
            connection.execute(_FOUND.update().where(*found).values(accountability=degree))
        if _is_consequence(verdict):
            connection.execute(_FOUND.delete().where(*found))
        elif verdict.get("severity") != "observation":
            kept.append(degree)
    if report.get("status") == "finished":
        strongest = min(kept, key=_DEGREES.index, default=None)
        changed = _RUNS.update().where(_RUNS.c.seq == run_seq)
        connection.execute(changed.values(violations=len(kept)))
        # It stays unknown where it was not recorded: avoidability was not, either.
        known = changed.where(_RUNS.c.accountability.is_not(None))
        connection.execute(known.values(accountability=strongest))


def _degree(verdict: Mapping[str, Any]) -> str:
    at_fault, avoidable = verdict.get("at_fault"), verdict.get("avoidable")
    if at_fault:
        return {"no": "unavoidable", "not_measurable": "not_measurable"}.get(
            str(avoidable), "avoidable"
        )
    if at_fault is False:
        return "preventable" if avoidable == "yes" else "not_at_fault"
    return "undetermined" if verdict.get("undetermined") else "not_judged"


def _is_consequence(verdict: Mapping[str, Any]) -> bool:
    reason = (verdict.get("evidence") or {}).get("reason")
    return verdict["oracle"] == "destination" and reason in _ENDS


def _count_failures(connection: sa.Connection) -> None:
    """Counts by the default definition; violations without a known degree count."""
    counted = sa.or_(_FOUND.c.accountability.is_(None), _FOUND.c.accountability.in_(_ACCOUNTABLE))
    of_runs = _FOUND.update().where(_FOUND.c.run_seq.is_not(None), sa.not_(counted))
    connection.execute(of_runs.values(is_counted=sa.false()))
    number = (
        sa.select(sa.func.count())
        .where(_FOUND.c.run_seq == _RUNS.c.seq, _FOUND.c.is_counted)
        .scalar_subquery()
    )
    # Versions that did not list the violations of runs leave theirs unknown.
    is_listed = sa.exists().where(_FOUND.c.run_seq == _RUNS.c.seq)
    finished = _RUNS.update().where(
        _RUNS.c.status == "finished", sa.or_(is_listed, _RUNS.c.violations == 0)
    )
    connection.execute(finished.values(failures=number))
    connection.execute(_RUNS.update().where(_RUNS.c.status == "agent_failed").values(failures=1))


def _define_campaigns(connection: sa.Connection) -> None:
    for table in (_CAMPAIGNS, _STUDIES):
        for seq, text in connection.execute(sa.select(table.c.seq, table.c.document)).all():
            document = json.loads(text)
            document.setdefault("counts", "possibly_at_fault")
            content = json.dumps(document, ensure_ascii=False)
            connection.execute(table.update().where(table.c.seq == seq).values(document=content))
    query = sa.select(_CAMPAIGNS.c.seq, _CAMPAIGNS.c.batch_id, _CAMPAIGNS.c.document)
    for seq, batch_id, text in connection.execute(query.where(_CAMPAIGNS.c.batch_id != "")).all():
        document = json.loads(text)
        definition: dict[str, Any] = {"counts": document["counts"]}
        if document.get("oracles") is not None:
            definition["oracles"] = sorted(document["oracles"])
        batch = sa.select(_BATCHES.c.seq).where(_BATCHES.c.id == batch_id).scalar_subquery()
        number = (
            sa.select(sa.func.count())
            .where(_FAILURES.c.campaign_seq == seq, _FAILURES.c.number == _RUNS.c.item)
            .scalar_subquery()
        )
        of_batch = _RUNS.update().where(_RUNS.c.batch_seq == batch)
        connection.execute(of_batch.values(definition=json.dumps(definition)))
        connection.execute(of_batch.where(_RUNS.c.status == "finished").values(failures=number))


def _mark_what_only_campaigns_count(connection: sa.Connection) -> None:
    """Marks observations, and what follows: campaigns keep these where they name the oracle."""
    concerned = sa.or_(
        _FAILURES.c.oracle == "destination", _FAILURES.c.verdict.like('%"observation"%')
    )
    key = _FAILURES.c.campaign_seq, _FAILURES.c.number, _FAILURES.c.place
    rows = connection.execute(sa.select(*key, _FAILURES.c.verdict).where(concerned)).all()
    for campaign_seq, number, place, text in rows:
        verdict = json.loads(text)
        if verdict.get("severity") == "observation" or _is_consequence(verdict):
            same = _FOUND.update().where(
                _FOUND.c.campaign_seq == campaign_seq,
                _FOUND.c.number == number,
                _FOUND.c.place == place,
            )
            connection.execute(same.values(is_violation=sa.false()))


def _fill_facets(connection: sa.Connection) -> None:
    """Assigns its present facets to each run, and counts the runs of each facet again."""
    before = {row.key: row for row in connection.execute(sa.select(_FACETS)).all()}
    violated, failing = _RUNS.c.violations > 0, _RUNS.c.failures > 0
    parts = (_RUNS.c.facet, _RUNS.c.accountability, violated, failing)
    rows: dict[int, dict[str, Any]] = {}
    query = sa.select(*parts, sa.func.count()).group_by(*parts)
    moves = []
    for key, degree, is_violated, fails, number in connection.execute(query).all():
        old = before[key]
        facet = Facet(
            agent=old.agent,
            town=old.town,
            status=old.status,
            violated=None if is_violated is None else bool(is_violated),
            accountability=degree,
            configuration=old.configuration,
            configuration_id=old.configuration_id,
            failing=None if fails is None else bool(fails),
        )
        new = facet_key(facet)
        known = rows.get(new, {"runs": 0})["runs"]
        rows[new] = {**_values(facet), "key": new, "runs": known + number}
        moves.append((key, degree, is_violated, fails, new))
    # New numbers are marked by their sign until all are given, as one may be another's old number.
    for key, degree, is_violated, fails, new in moves:
        same = _RUNS.update().where(
            _RUNS.c.facet == key,
            _RUNS.c.accountability.is_not_distinct_from(degree),
            violated.is_not_distinct_from(is_violated),
            failing.is_not_distinct_from(fails),
        )
        connection.execute(same.values(facet=-1 - new))
    connection.execute(_RUNS.update().values(facet=-1 - _RUNS.c.facet))
    of_run = sa.select(_RUNS.c.facet).where(_RUNS.c.seq == _VERDICTS.c.run_seq).scalar_subquery()
    connection.execute(_VERDICTS.update().values(facet=of_run))
    connection.execute(_FACETS.delete())
    if rows:
        connection.execute(_FACETS.insert(), list(rows.values()))
    connection.execute(_BATCH_FACETS.delete())
    of_batch = _RUNS.c.batch_seq, _RUNS.c.facet
    numbers = sa.select(*of_batch, sa.func.count()).group_by(*of_batch)
    connection.execute(_BATCH_FACETS.insert().from_select(["batch_seq", "facet", "runs"], numbers))


def _values(facet: Facet) -> dict[str, Any]:
    names: Iterable[str] = (*_FACET, "configuration_id", "failing")
    return {name: getattr(facet, name) for name in names}


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
