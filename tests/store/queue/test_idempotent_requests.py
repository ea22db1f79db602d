from __future__ import annotations

from datetime import timedelta

from drivora_service.store.database import Database


def test_the_first_request_is_fresh_and_later_ones_learn_its_answer(database: Database) -> None:
    with database.write() as transaction:
        assert transaction.idempotency.reserve("key", "print").fresh
    with database.write() as transaction:
        second = transaction.idempotency.reserve("key", "other")
        assert (second.fresh, second.fingerprint, second.reference) == (False, "print", None)
        transaction.idempotency.complete("key", "answer")
    with database.write() as transaction:
        assert transaction.idempotency.reserve("key", "print").reference == "answer"


def test_a_request_that_failed_frees_its_key_and_an_answered_one_keeps_it(
    database: Database,
) -> None:
    with database.write() as transaction:
        transaction.idempotency.reserve("failed", "print")
        transaction.idempotency.reserve("done", "print")
        transaction.idempotency.complete("done", "answer")
    with database.write() as transaction:
        transaction.idempotency.give_up("failed")
        transaction.idempotency.give_up("done")
    with database.write() as transaction:
        assert transaction.idempotency.reserve("failed", "print").fresh
        assert not transaction.idempotency.reserve("done", "print").fresh


def test_requests_that_died_with_a_server_are_forgotten_at_the_next_start(
    database: Database,
) -> None:
    with database.write() as transaction:
        transaction.idempotency.reserve("dead", "print")
        transaction.idempotency.reserve("done", "print")
        transaction.idempotency.complete("done", "answer")
    with database.write() as transaction:
        transaction.idempotency.clean(unfinished=False)
        assert not transaction.idempotency.reserve("dead", "print").fresh
        transaction.idempotency.clean(unfinished=True)
        assert transaction.idempotency.reserve("dead", "print").fresh
        assert not transaction.idempotency.reserve("done", "print").fresh
        transaction.idempotency.clean(unfinished=False, older_than=timedelta(0))
        assert transaction.idempotency.reserve("done", "print").fresh
