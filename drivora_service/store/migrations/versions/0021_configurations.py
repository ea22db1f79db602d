"""Runs, campaigns, failures and runs of suites name the ADS with its parameters.

Stored scenarios and campaigns say what drove, and the catalogue of this installation has the
defaults. An ADS that it does not know, such as one of the operator's own, stays without an id:
its defaults are not known here.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import sqlalchemy as sa
from alembic import op

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.runs.facets import Facet, facet_key

revision = "0021"
down_revision = "0020"
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
)
_NAMED = ("runs", "campaigns", "found_failures", "facets")
_COLUMNS = ("configuration", "configuration_id")


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(one) for one in (*columns, *_COLUMNS)))


_RUNS = _table("runs", "seq", "batch_seq", "document_sha256", "agent", "agent_override", "facet")
_CAMPAIGNS = _table("campaigns", "seq", "batch_id", "agent", "document")
_FOUND = _table("found_failures", "seq", "run_seq", "campaign_seq", "agent")
_FACETS = _table("facets", "key", "agent", "town", "status", "violated", "accountability", "runs")
_BATCH_FACETS = sa.table(
    "batch_facets", *(sa.column(one) for one in ("batch_seq", "facet", "runs"))
)
_BATCHES = sa.table("batches", sa.column("seq"), sa.column("id"))
_VERDICTS = sa.table("verdicts", sa.column("run_seq"), sa.column("facet"))
_DOCUMENTS = sa.table("documents", sa.column("sha256"), sa.column("body"))


def upgrade() -> None:
    for table in _NAMED:
        for name, length in zip(_COLUMNS, (400, 8), strict=True):
            _add_column(table, name, length)
    _add_column("suite_runs", "configuration_id", 8)
    connection = op.get_bind()
    for named in (_RUNS, _CAMPAIGNS, _FOUND, _FACETS):
        connection.execute(named.update().values(configuration=named.c.agent))
    agents = AgentCatalogue()
    known = frozenset(agents.names())
    _fill_runs(connection, agents, known)
    _fill_campaigns(connection, agents, known)
    _fill_found(connection)
    _fill_facets(connection)
    op.drop_index("ix_found_failures_group", table_name="found_failures")
    op.create_index("ix_found_failures_group", "found_failures", list(_GROUPED))


def _add_column(table: str, name: str, length: int) -> None:
    empty = sa.text("''")
    op.add_column(
        table, sa.Column(name, sa.String(length=length), server_default=empty, nullable=False)
    )


def _fill_runs(connection: sa.Connection, agents: AgentCatalogue, known: frozenset[str]) -> None:
    chosen = _RUNS.c.document_sha256, _RUNS.c.agent_override
    pairs = connection.execute(sa.select(*chosen).distinct().order_by(*chosen)).all()
    change = _RUNS.update().where(
        _RUNS.c.document_sha256 == sa.bindparam("document"),
        _RUNS.c.agent_override == sa.bindparam("override"),
    )
    for start in range(0, len(pairs), _CHUNK):
        chunk = pairs[start : start + _CHUNK]
        wanted = {sha256 for sha256, _ in chunk}
        query = sa.select(_DOCUMENTS.c.sha256, _DOCUMENTS.c.body)
        found = connection.execute(query.where(_DOCUMENTS.c.sha256.in_(wanted))).all()
        bodies = {sha256: body for sha256, body in found}  # noqa: C416 # rows, not pairs
        rows = [
            {"document": sha256, "override": override, "words": filled.words, "id": filled.id}
            for sha256, override in chunk
            if (filled := _of_egos(_egos(bodies.get(sha256, "")), override, agents, known))
        ]
        if rows:
            connection.execute(
                change.values(
                    configuration=sa.bindparam("words"), configuration_id=sa.bindparam("id")
                ),
                rows,
            )


def _fill_campaigns(
    connection: sa.Connection, agents: AgentCatalogue, known: frozenset[str]
) -> None:
    chosen = _CAMPAIGNS.c.seq, _CAMPAIGNS.c.batch_id, _CAMPAIGNS.c.document
    for seq, batch_id, document in connection.execute(sa.select(*chosen)).all():
        filled = _of_egos(_egos_of_campaign(document), "", agents, known)
        if filled is None:
            continue
        values = {"configuration": filled.words, "configuration_id": filled.id}
        connection.execute(_CAMPAIGNS.update().where(_CAMPAIGNS.c.seq == seq).values(values))
        # Its runs have the seed scenario of their genes, and the agents of all seeds.
        batch = sa.select(_BATCHES.c.seq).where(_BATCHES.c.id == batch_id).scalar_subquery()
        if batch_id:
            connection.execute(_RUNS.update().where(_RUNS.c.batch_seq == batch).values(values))


def _fill_found(connection: sa.Connection) -> None:
    for owner, number in ((_RUNS, _FOUND.c.run_seq), (_CAMPAIGNS, _FOUND.c.campaign_seq)):
        values = {
            name: sa.select(owner.c[name]).where(owner.c.seq == number).scalar_subquery()
            for name in _COLUMNS
        }
        connection.execute(_FOUND.update().where(number.is_not(None)).values(values))


def _fill_facets(connection: sa.Connection) -> None:
    """Gives the runs of each configuration a facet of their own, and counts again."""
    before = {row.key: row for row in connection.execute(sa.select(_FACETS)).all()}
    grouped = (_RUNS.c.facet, _RUNS.c.configuration, _RUNS.c.configuration_id)
    counted = sa.select(*grouped, sa.func.count().label("runs")).group_by(*grouped)
    rows: dict[int, dict[str, Any]] = {}
    for key, words, configuration_id, runs in connection.execute(counted).all():
        old = before[key]
        facet = Facet(
            agent=old.agent,
            town=old.town,
            status=old.status,
            violated=None if old.violated is None else bool(old.violated),
            accountability=old.accountability,
            configuration_id=configuration_id,
        )
        new = facet_key(facet)
        rows[new] = {
            "key": new,
            "agent": facet.agent,
            "town": facet.town,
            "status": facet.status,
            "violated": facet.violated,
            "accountability": facet.accountability,
            "configuration": words,
            "configuration_id": configuration_id,
            "runs": runs + rows.get(new, {"runs": 0})["runs"],
        }
        if new != key:
            of_facet = _RUNS.c.facet == key, _RUNS.c.configuration_id == configuration_id
            connection.execute(_RUNS.update().where(*of_facet).values(facet=new))
    of_run = sa.select(_RUNS.c.facet).where(_RUNS.c.seq == _VERDICTS.c.run_seq).scalar_subquery()
    connection.execute(_VERDICTS.update().values(facet=of_run))
    connection.execute(_FACETS.delete())
    if rows:
        connection.execute(_FACETS.insert(), list(rows.values()))
    connection.execute(_BATCH_FACETS.delete())
    of_batch = _RUNS.c.batch_seq, _RUNS.c.facet
    numbers = sa.select(*of_batch, sa.func.count()).group_by(*of_batch)
    connection.execute(_BATCH_FACETS.insert().from_select(["batch_seq", "facet", "runs"], numbers))


def _egos_of_campaign(document: str) -> list[AgentChoice]:
    content = json.loads(document)
    own = content.get("agent")
    if own:
        return [AgentChoice(name=own["name"], parameters=own.get("parameters") or {})]
    seeds = content.get("scenarios") or ()
    scenarios = [one["scenario"] for one in seeds] or [content.get("scenario")]
    return [choice for one in scenarios for choice in _choices(one)]


def _egos(body: str) -> list[AgentChoice]:
    try:
        return list(_choices(json.loads(body)))
    except ValueError:
        # What was posted and is no scenario.
        return []


def _choices(scenario: Any) -> Iterator[AgentChoice]:
    egos = scenario.get("ego_vehicles") if isinstance(scenario, Mapping) else None
    for ego in egos if isinstance(egos, list) else ():
        agent = ego.get("agent") if isinstance(ego, Mapping) else None
        if isinstance(agent, Mapping) and isinstance(agent.get("name"), str):
            parameters = agent.get("parameters")
            yield AgentChoice(
                name=agent["name"],
                parameters=parameters if isinstance(parameters, Mapping) else {},
            )


def _of_egos(
    choices: list[AgentChoice], override: str, agents: AgentCatalogue, known: frozenset[str]
) -> AgentConfiguration | None:
    """Returns the configuration of egos; ``None`` if an agent is not known here."""
    if override:
        choices = [one if one.name == override else AgentChoice(name=override) for one in choices]
    if not choices or any(one.name not in known for one in choices):
        return None
    return agents.configuration(choices)


def downgrade() -> None:
    raise NotImplementedError("restore the backup that was made before the upgrade")
