"""Groups of failures, what people decide about them, and baselines."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import TypeVar

import pytest
from sqlalchemy import select, update

from drivora_service.errors import Conflict, InvalidDocument, UnknownName
from drivora_service.store.campaigns.campaign_records import NewCampaign
from drivora_service.store.database import Database, Transaction
from drivora_service.store.failures.failure_records import FoundFailure, FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_records import (
    ChangedPart,
    FailureGroup,
    GroupFilter,
    GroupStatus,
    NewDecision,
    SinceBaseline,
    group_id,
)
from drivora_service.store.runs.run_records import Priority
from tests.store.campaigns.test_campaign_repository import append, create, evaluation
from tests.store.samples import claim, finish, finished, new_run, only_sqlite, register
from tests.store.test_query_plans import plan, queries

T = TypeVar("T")
BEGIN = datetime(2026, 3, 1, tzinfo=UTC)
COLLISION, LIGHT, SPEED = group_id("collision"), group_id("red_light"), group_id("speeding")


def write(database: Database, do: Callable[[Transaction], T]) -> T:
    with database.write() as transaction:
        return do(transaction)


def run_batch(database: Database, *oracles: str, town: str = "grid") -> str:
    """A batch with a run for each oracle, which violates it."""
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI).id
        transaction.jobs.submit(
            [new_run(f"{{{batch}{n}}}", town=town) for n in range(len(oracles))], batch_id=batch
        )
    owner = register(database)
    runs = claim(database, owner, len(oracles))
    finish(database, owner, *(finished(r, o) for r, o in zip(runs, oracles, strict=True)))
    return batch


@pytest.fixture
def batches(database: Database) -> tuple[str, str]:
    """An old batch and a new one; failures are found a minute apart."""
    old = run_batch(database, "collision", "speeding", "collision")
    new = run_batch(database, "collision", "red_light", "red_light", town="tee")
    with database.write() as transaction:
        for seq in transaction.session.scalars(select(FoundRow.seq)):
            transaction.session.execute(
                update(FoundRow)
                .where(FoundRow.seq == seq)
                .values(found_at=BEGIN + timedelta(minutes=seq))
            )
    return old, new


def groups(database: Database, wanted: GroupFilter | None = None) -> dict[str, FailureGroup]:
    with database.read() as transaction:
        page = transaction.groups.page(wanted or GroupFilter(), limit=500)
    assert page.next_page_token == ""
    return {one.id: one for one in page.items}


def failures(database: Database, group: str = "") -> list[FoundFailure]:
    with database.read() as transaction:
        return list(transaction.found.page(FoundFilter(group=group), limit=500).items)


def test_a_group_about_which_nothing_was_decided_has_the_id_of_its_name(
    database: Database, batches: tuple[str, str]
) -> None:
    found = groups(database)
    assert {one.names: one.failures for one in found.values()} == {
        ("collision",): 3,
        ("red_light",): 2,
        ("speeding",): 1,
    }
    assert list(found) == [LIGHT, COLLISION, SPEED], "the last seen first"
    one = found[COLLISION]
    assert (one.status, one.label, one.note, one.assignee) == (GroupStatus.NEW, "", "", "")
    assert (one.changed_at, one.changed_by, one.status_at, one.revision) == (None, "", None, 0)
    assert {f.group_id for f in failures(database)} == set(found)
    assert {f.group_id for f in failures(database, COLLISION)} == {COLLISION}
    with database.read() as transaction:
        assert transaction.groups.get(COLLISION) == one
        assert transaction.groups.changes(COLLISION) == ()


def test_decisions_stay_with_their_group_and_are_noted(
    database: Database, batches: tuple[str, str]
) -> None:
    first = NewDecision(status=GroupStatus.KNOWN, note="It brakes late.")
    assert write(database, lambda t: t.decisions.decide(COLLISION, first, by="Ada")) == COLLISION
    seen = groups(database)[COLLISION]
    assert (seen.status, seen.note, seen.changed_by) == (first.status, first.note, "Ada")
    then = NewDecision(status=GroupStatus.FIXED, label="late braking", assignee="Bo")
    write(database, lambda t: t.decisions.decide(COLLISION, then, by="Bo", revision=seen.revision))
    one = groups(database)[COLLISION]
    assert (one.label, one.assignee, one.note) == ("late braking", "Bo", "It brakes late.")
    assert one.failures == 3
    assert one.revision > seen.revision
    with database.read() as transaction:
        changes = transaction.groups.changes(COLLISION)
    assert [(c.by, c.what, c.before, c.after) for c in reversed(changes)] == [
        ("Ada", ChangedPart.STATUS, "new", "known"),
        ("Ada", ChangedPart.NOTE, "", "It brakes late."),
        ("Bo", ChangedPart.STATUS, "known", "fixed"),
        ("Bo", ChangedPart.LABEL, "", "late braking"),
        ("Bo", ChangedPart.ASSIGNEE, "", "Bo"),
    ]
    assert changes[0].at == one.changed_at
    # What was decided is about failures that are found later, too.
    run_batch(database, "collision")
    assert (groups(database)[COLLISION].failures, groups(database)[COLLISION].label) == (
        4,
        "late braking",
    )


def test_who_has_not_seen_the_last_decision_is_told(
    database: Database, batches: tuple[str, str]
) -> None:
    known = NewDecision(status=GroupStatus.KNOWN)
    write(database, lambda t: t.decisions.decide(COLLISION, known, by="Ada", revision=0))
    for old in (0, 10_000):
        with (
            pytest.raises(Conflict, match="Ada changed the group meanwhile"),
            database.write() as transaction,
        ):
            transaction.decisions.decide(COLLISION, NewDecision(), revision=old)
    assert groups(database)[COLLISION].status is GroupStatus.KNOWN


def test_a_fixed_group_that_is_found_again_is_back(
    database: Database, batches: tuple[str, str]
) -> None:
    fixed = NewDecision(status=GroupStatus.FIXED)
    write(database, lambda t: t.decisions.decide(COLLISION, fixed))
    assert not groups(database)[COLLISION].is_back
    run_batch(database, "collision")
    assert groups(database)[COLLISION].is_back
    write(database, lambda t: t.decisions.decide(COLLISION, NewDecision(status=GroupStatus.KNOWN)))
    assert not groups(database)[COLLISION].is_back


def test_groups_are_filtered_by_what_was_decided(
    database: Database, batches: tuple[str, str]
) -> None:
    decision = NewDecision(status=GroupStatus.KNOWN, assignee="Ada")
    write(database, lambda t: t.decisions.decide(COLLISION, decision))

    def with_status(*statuses: GroupStatus, assignee: str = "") -> set[str]:
        return set(groups(database, GroupFilter(statuses=frozenset(statuses), assignee=assignee)))

    assert with_status(GroupStatus.KNOWN) == {COLLISION}
    assert with_status(GroupStatus.NEW) == {LIGHT, SPEED}
    assert with_status(GroupStatus.NEW, GroupStatus.KNOWN) == {COLLISION, LIGHT, SPEED}
    assert with_status(assignee="Ada") == {COLLISION}
    assert with_status(GroupStatus.NEW, assignee="Ada") == set()


def test_merged_groups_are_one_also_for_failures_found_later(
    database: Database, batches: tuple[str, str]
) -> None:
    write(database, lambda t: t.decisions.decide(LIGHT, NewDecision(label="runs red")))
    assert write(database, lambda t: t.decisions.merge(COLLISION, [LIGHT], by="Ada")) == COLLISION
    found = groups(database)
    assert set(found) == {COLLISION, SPEED}
    one = found[COLLISION]
    assert (one.names, one.failures) == (("collision", "red_light"), 5)
    assert (one.campaigns, one.towns) == (0, 2)
    members = failures(database, COLLISION)
    assert [f.group_name for f in members].count("red_light") == 2
    assert {f.group_id for f in members} == {COLLISION}
    assert (one.first_seen, one.last_seen) == (members[-1].found_at, members[0].found_at)
    run_batch(database, "red_light")
    assert groups(database)[COLLISION].failures == 6
    with database.read() as transaction:
        # Links to the merged group lead to where its failures are now.
        assert transaction.groups.get(LIGHT).id == COLLISION
        assert transaction.groups.changes(LIGHT) == transaction.groups.changes(COLLISION)
        merged, label = transaction.groups.changes(COLLISION)
    assert (merged.what, merged.after, merged.by) == (ChangedPart.MERGED, "runs red", "Ada")
    assert label.what is ChangedPart.LABEL
    assert len(failures(database, LIGHT)) == 6
    with pytest.raises(Conflict):
        write(database, lambda t: t.decisions.merge(COLLISION, [LIGHT]))
    write(database, lambda t: t.decisions.merge(SPEED, [LIGHT]))
    (all_of_them,) = groups(database)
    assert all_of_them == SPEED
    assert len(failures(database, LIGHT)) == 7


def test_failures_are_split_off_without_those_found_later(
    database: Database, batches: tuple[str, str]
) -> None:
    first = failures(database, COLLISION)[-1]
    new = write(
        database,
        lambda t: t.decisions.split(COLLISION, failures=[first.id], label="at the bend", by="Ada"),
    )
    found = groups(database)
    assert (found[new].failures, found[new].label, found[new].changed_by) == (
        1,
        "at the bend",
        "Ada",
    )
    assert found[new].names == ("collision",)
    assert found[COLLISION].failures == 2
    assert [f.id for f in failures(database, new)] == [first.id]
    run_batch(database, "collision")
    assert groups(database)[new].failures == 1
    assert groups(database)[COLLISION].failures == 3
    with database.read() as transaction:
        (old_side,) = transaction.groups.changes(COLLISION)
        (new_side,) = transaction.groups.changes(new)
    assert (old_side.what, old_side.before) == (ChangedPart.SPLIT, "1 failures")
    assert (new_side.before, new_side.after) == ("collision", "at the bend")
    write(database, lambda t: t.decisions.merge(COLLISION, [new]))
    assert groups(database)[COLLISION].failures == 4
    with database.read() as transaction:
        assert transaction.groups.get(new).id == COLLISION


def test_names_are_split_off_with_those_found_later(
    database: Database, batches: tuple[str, str]
) -> None:
    write(database, lambda t: t.decisions.merge(COLLISION, [LIGHT, SPEED]))
    new = write(database, lambda t: t.decisions.split(COLLISION, names=["red_light", "collision"]))
    assert {one.id: one.names for one in groups(database).values()} == {
        new: ("collision", "red_light"),
        COLLISION: ("speeding",),
    }
    run_batch(database, "red_light", "speeding")
    assert {one.id: one.failures for one in groups(database).values()} == {new: 6, COLLISION: 2}


def test_what_cannot_be_decided_is_refused_and_changes_nothing(
    database: Database, batches: tuple[str, str]
) -> None:
    before = groups(database)
    stranger = failures(database, LIGHT)[0].id
    all_of_it = [failure.id for failure in failures(database, COLLISION)]
    refused: list[tuple[type[Exception], Callable[[Transaction], object]]] = [
        (UnknownName, lambda t: t.decisions.decide("0" * 24, NewDecision(note="n"))),
        (UnknownName, lambda t: t.decisions.merge("0" * 24, [LIGHT])),
        (UnknownName, lambda t: t.decisions.merge(LIGHT, [SPEED, "0" * 24])),
        (UnknownName, lambda t: t.decisions.split(COLLISION, failures=[stranger])),
        (UnknownName, lambda t: t.decisions.split(COLLISION, names=["red_light"])),
        (Conflict, lambda t: t.decisions.split(COLLISION)),
        (Conflict, lambda t: t.decisions.split(COLLISION, failures=all_of_it)),
        (Conflict, lambda t: t.decisions.split(COLLISION, names=["collision"])),
        (Conflict, lambda t: t.decisions.merge(LIGHT, [LIGHT])),
    ]
    for error, do in refused:
        with pytest.raises(error):
            write(database, do)
    assert groups(database) == before
    with database.read() as transaction, pytest.raises(UnknownName):
        transaction.groups.get("0" * 24)
    assert failures(database, "0" * 24) == []


def test_groups_are_new_the_same_or_gone_since_a_baseline(
    database: Database, batches: tuple[str, str]
) -> None:
    old, new = batches
    with database.read() as transaction:
        wanted = FoundFilter()
        by_batch = transaction.groups.baseline(wanted, old)
        by_time = transaction.groups.baseline(wanted, (BEGIN + timedelta(minutes=4)).isoformat())
        other_way = transaction.groups.baseline(wanted, new)
    for baseline in (by_batch, by_time):
        found = groups(database, GroupFilter(baseline=baseline))
        assert {
            one.names[0]: (one.since_baseline, one.failures, one.baseline_failures)
            for one in found.values()
        } == {
            "red_light": (SinceBaseline.NEW, 2, 0),
            "collision": (SinceBaseline.SAME, 1, 2),
            "speeding": (SinceBaseline.GONE, 0, 1),
        }
        gone = found[SPEED]
        assert (gone.avoidable, gone.others, gone.campaigns, gone.towns) == (0, 0, 0, 0)
        assert gone.example.group_id == SPEED
        for since in SinceBaseline:
            only = groups(database, GroupFilter(baseline=baseline, since_baseline=since))
            assert only == {k: v for k, v in found.items() if v.since_baseline is since}
    back = groups(database, GroupFilter(baseline=other_way))
    assert back[LIGHT].since_baseline is SinceBaseline.GONE
    # The filter of the failures is that of the baseline as well.
    in_tee = FoundFilter(town="tee")
    with database.read() as transaction:
        baseline = transaction.groups.baseline(in_tee, old)
    found = groups(database, GroupFilter(failures=in_tee, baseline=baseline))
    assert {one.since_baseline for one in found.values()} == {SinceBaseline.NEW}


def test_campaigns_and_studies_are_baselines(database: Database) -> None:
    first = create(database)
    append(database, first, evaluation(0, violated=(True,)))
    study = write(database, lambda t: t.studies.create(name="s", document="{}"))
    with database.write() as transaction:
        second = transaction.campaigns.create(
            NewCampaign(
                name="of a study", document="{}", tester="random", agent="idm", town="tee-town",
                network_sha256="a" * 64, budget=10, study_id=study,
            )
        ).id  # fmt: skip
    append(database, second, evaluation(0, violated=(False,), oracle="red_light"))
    # A failure of a single run belongs to neither.
    run_batch(database, "red_light")
    for text, new in ((first, LIGHT), (study, COLLISION), (second, COLLISION)):
        with database.read() as transaction:
            baseline = transaction.groups.baseline(FoundFilter(), text)
        found = groups(database, GroupFilter(baseline=baseline))
        assert [k for k, v in found.items() if v.since_baseline is SinceBaseline.NEW] == [new]
        if text != first:
            assert found[LIGHT].since_baseline is SinceBaseline.SAME
    for text in ("", "yesterday", "2026-11-20", "2026-11-20T08:00:00", "0" * 24):
        with database.read() as transaction, pytest.raises(InvalidDocument, match="baseline"):
            transaction.groups.baseline(FoundFilter(), text)


def test_pages_of_groups_follow_one_another(database: Database, batches: tuple[str, str]) -> None:
    write(database, lambda t: t.decisions.merge(COLLISION, [SPEED]))
    with database.read() as transaction:
        baseline = transaction.groups.baseline(FoundFilter(), batches[0])
        for wanted in (GroupFilter(), GroupFilter(baseline=baseline)):
            whole = transaction.groups.page(wanted, limit=10).items
            found: list[FailureGroup] = []
            token = ""
            while token or not found:
                page = transaction.groups.page(wanted, limit=1, page_token=token)
                found += page.items
                token = page.next_page_token
            assert tuple(found) == whole
            assert len(whole) == 2


@only_sqlite
def test_a_group_is_found_by_its_id_without_reading_all_failures(
    database: Database, batches: tuple[str, str]
) -> None:
    new = write(
        database,
        lambda t: t.decisions.split(COLLISION, failures=[failures(database, COLLISION)[0].id]),
    )
    for wanted in (SPEED, COLLISION, new):
        with queries(database) as asked, database.read() as transaction:
            transaction.found.page(FoundFilter(group=wanted), limit=2)
            transaction.groups.page(GroupFilter(failures=FoundFilter(group=wanted)), limit=2)
        steps = [step for query in asked for step in plan(database, *query)]
        read = [step for step in steps if "found_failures" in step and "rowid" not in step]
        assert read != []
        for step in read:
            assert "SEARCH" in step or step == "SCAN found_failures", step
