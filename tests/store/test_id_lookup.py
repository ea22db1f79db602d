"""Finding ids by names, by their first digits, and of the newest."""

from __future__ import annotations

import pytest

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.errors import AmbiguousName, UnknownName
from drivora_service.store.database import Database
from drivora_service.store.failures.group_records import NewDecision, group_id
from drivora_service.store.id_lookup import LEAST_DIGITS, find_id
from drivora_service.store.id_records import FoundId, IdKind, is_whole_id
from drivora_service.store.runs.run_records import Batch, Priority
from tests.store.campaigns.test_campaign_repository import create
from tests.store.samples import (
    claim,
    finish,
    finished,
    new_minimization,
    new_run,
    only_sqlite,
    register,
    submit,
)
from tests.store.test_query_plans import plan, queries


@pytest.fixture
def batches(database: Database) -> list[Batch]:
    """Batches, the newest first; the name of the oldest one is that of the newest."""
    made = []
    for name in ("nightly", "second", "third", "nightly"):
        submit(database, 1)
        with database.write() as transaction:
            made.append(transaction.batches.create(name=name, priority=Priority.CI))
    return made[::-1]


def found(database: Database, wanted: str, *kinds: IdKind, newest: bool = False) -> FoundId:
    with database.read() as transaction:
        return find_id(transaction.session, kinds, wanted, newest_of_name=newest)


def test_a_batch_is_found_by_its_id_its_name_and_as_the_newest(
    database: Database, batches: list[Batch]
) -> None:
    for batch in batches:
        assert found(database, batch.id, IdKind.BATCH).id == batch.id
    third = found(database, "third", IdKind.BATCH)
    assert third == FoundId(
        kind=IdKind.BATCH, id=batches[1].id, name="third", created_at=batches[1].created_at
    )
    assert found(database, "latest", IdKind.BATCH).id == batches[0].id


def test_the_first_digits_of_an_id_are_enough_if_no_other_id_begins_so(
    database: Database, batches: list[Batch]
) -> None:
    ids = sorted(batch.id for batch in batches)
    for place, (before, own, after) in enumerate(
        zip(["", *ids], ids, [*ids[1:], ""], strict=False)
    ):
        digits = next(
            n
            for n in range(LEAST_DIGITS, 25)
            if not before.startswith(own[:n]) and not after.startswith(own[:n])
        )
        assert found(database, own[:digits], IdKind.BATCH).id == own, place
        if digits > LEAST_DIGITS:
            with pytest.raises(AmbiguousName) as raised:
                found(database, own[: digits - 1], IdKind.BATCH)
            assert own in str(raised.value)


def test_a_few_digits_name_nothing(database: Database, batches: list[Batch]) -> None:
    alone = batches[0].id
    for digits in range(1, LEAST_DIGITS):
        with pytest.raises(UnknownName):
            found(database, alone[:digits], IdKind.BATCH)


def test_a_name_of_several_is_refused_with_all_of_them_the_newest_first(
    database: Database, batches: list[Batch]
) -> None:
    with pytest.raises(AmbiguousName) as raised:
        found(database, "nightly", IdKind.BATCH)
    first, *candidates = str(raised.value).splitlines()
    assert first == ("'nightly' is the name of 2 batches. Give the id of one, or its first digits:")
    assert [line.split()[0] for line in candidates] == [batches[0].id, batches[-1].id]
    assert all(line.endswith(" UTC  nightly") for line in candidates)
    assert found(database, "nightly", IdKind.BATCH, newest=True).id == batches[0].id


def test_many_candidates_are_cut_short(database: Database) -> None:
    with database.write() as transaction:
        for _ in range(12):
            transaction.batches.create(name="same", priority=Priority.CI)
    with pytest.raises(AmbiguousName) as raised:
        found(database, "same", IdKind.BATCH)
    lines = str(raised.value).splitlines()
    assert "more than 10 batches" in lines[0]
    assert (len(lines), lines[-1]) == (12, "…")


def test_latest_is_the_newest_whatever_has_this_name(database: Database) -> None:
    with database.write() as transaction:
        named = transaction.batches.create(name="latest", priority=Priority.CI).id
        newest = transaction.batches.create(name="other", priority=Priority.CI).id
    assert found(database, "latest", IdKind.BATCH).id == newest
    assert found(database, named, IdKind.BATCH).id == named


@pytest.mark.parametrize("unknown", ["jobs", "%", "_", "01g", " nightly", "NIGHTLY2", "", "Ω"])
def test_what_fits_nothing_is_refused(
    database: Database, batches: list[Batch], unknown: str
) -> None:
    assert len(batches) == 4
    with pytest.raises(UnknownName, match="unknown batch"):
        found(database, unknown, IdKind.BATCH)


@pytest.mark.parametrize("near", ["nightl", "NIGHTLY", "nigthly", "ight"])
def test_a_similar_name_is_proposed(database: Database, batches: list[Batch], near: str) -> None:
    assert len(batches) == 4
    with pytest.raises(UnknownName, match="Did you mean 'nightly'"):
        found(database, near, IdKind.BATCH)


def test_without_a_similar_name_the_newest_is_named(
    database: Database, batches: list[Batch]
) -> None:
    with pytest.raises(UnknownName, match=rf"The newest is {batches[0].id} \(nightly\)"):
        found(database, "zzz", IdKind.BATCH)


@pytest.mark.parametrize("kind", IdKind)
def test_where_nothing_is_stored_the_error_says_how_to_begin(
    database: Database, kind: IdKind
) -> None:
    for wanted in ("latest", "anything", "01a2"):
        with pytest.raises(UnknownName, match=r"There is no .* yet: .*`drivora "):
            found(database, wanted, kind)


def test_of_several_kinds_the_newest_of_all_is_meant(
    database: Database, batches: list[Batch]
) -> None:
    kinds = (IdKind.BATCH, IdKind.CAMPAIGN, IdKind.STUDY)
    assert found(database, "latest", *kinds).id == batches[0].id
    with database.write() as transaction:
        study = transaction.studies.create(name="third", document="{}")
    assert found(database, "latest", *kinds).id == study
    assert found(database, study[:24], *kinds).kind is IdKind.STUDY
    with pytest.raises(AmbiguousName) as raised:
        found(database, "third", *kinds)
    assert "  study  third" in str(raised.value)
    assert "  batch  third" in str(raised.value)


def test_a_run_is_found_by_its_label_and_by_campaign_and_evaluation(database: Database) -> None:
    campaign = create(database, name="acme, first search")
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI).id
        runs = transaction.jobs.submit(
            [new_run("{1}", label="crossing-17"), new_run("{2}", label="late")], batch_id=batch
        )
    assert found(database, "crossing-17", IdKind.RUN).id == runs[0]
    assert found(database, "latest", IdKind.RUN).id == runs[1]
    for name in ("acme, first search", "latest", campaign):
        assert found(database, f"{name}-3", IdKind.RUN).id == f"{campaign}-3"
    with pytest.raises(UnknownName, match="unknown run 'acme-3'"):
        found(database, "acme-3", IdKind.RUN)


def test_minimisations_have_ids_only(database: Database) -> None:
    with database.write() as transaction:
        made = [transaction.minimizations.open(new_minimization(budget=n)) for n in (1, 2)]
    assert found(database, "latest", IdKind.MINIMIZATION).id == made[1]
    with pytest.raises(UnknownName):
        found(database, "", IdKind.MINIMIZATION)


@pytest.fixture
def failing(database: Database) -> tuple[str, str]:
    """The groups of two runs that fail, the last seen first."""
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI).id
        transaction.jobs.submit(
            [
                new_run("{1}", configuration=AgentConfiguration(id="0123abcd", words="idm")),
                new_run(
                    "{2}", configuration=AgentConfiguration(id="0123abce", words="idm (speed 2)")
                ),
            ],
            batch_id=batch,
        )
    owner = register(database)
    first, second = claim(database, owner, 2)
    finish(database, owner, finished(first, "collision"))
    finish(database, owner, finished(second, "speeding"))
    return group_id("speeding"), group_id("collision")


def test_groups_are_found_by_their_names_and_labels(
    database: Database, failing: tuple[str, str]
) -> None:
    latest, other = failing
    kind = IdKind.FAILURE_GROUP
    assert found(database, "latest", kind).id == latest
    assert found(database, other[:12], kind).id == other
    assert found(database, "collision", kind).id == other
    with database.write() as transaction:
        transaction.decisions.decide(other, NewDecision(label="stands too close"))
    named = found(database, "stands too close", kind)
    assert named.name == "stands too close"
    assert found(database, "collision", kind).id == named.id


@pytest.mark.usefixtures("failing")
def test_configurations_are_found_by_their_words(database: Database) -> None:
    kind = IdKind.CONFIGURATION
    assert found(database, "idm", kind).id == "0123abcd"
    assert found(database, "0123abce", kind).name == "idm (speed 2)"
    with pytest.raises(AmbiguousName, match="the beginning of the ids of 2 configurations"):
        found(database, "0123", kind)


@only_sqlite
@pytest.mark.parametrize("kind", [IdKind.RUN, IdKind.CAMPAIGN])
def test_an_id_and_the_newest_are_found_without_reading_all_rows(
    database: Database, kind: IdKind
) -> None:
    submit(database, 3)
    create(database)
    newest = found(database, "latest", kind).id
    for wanted in (newest, "latest"):
        with queries(database) as made:
            assert found(database, wanted, kind).id == newest
        assert made
        for query in made:
            # The newest is at the end of the table, whose rows are in the order of creation.
            assert query[0].rstrip().endswith("LIMIT ? OFFSET ?")
            assert not any("TEMP B-TREE" in step for step in plan(database, *query))


@pytest.mark.parametrize(
    ("text", "is_whole"),
    [
        ("0193a5b0c4d2000000000006", True),
        ("0193a5b0c4d2000000000006-12", True),
        ("0193a5b0c4d2000000000006-12-again", True),
        ("0193a5b0c4d200000000000", False),
        ("0193A5B0C4D2000000000006", False),
        ("0193a5b0c4d2000000000006-x", False),
        ("latest", False),
        ("c4b436a4", False),
    ],
)
def test_whole_ids_are_told_by_their_form(text: str, is_whole: bool) -> None:
    assert is_whole_id(text) == is_whole
