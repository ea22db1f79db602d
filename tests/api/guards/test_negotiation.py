from __future__ import annotations

import pytest
from fastapi import Request

from drivora_service.api.guards.negotiation import accepted_coding, accepted_form
from drivora_service.api.problem_details import ApiError

FORMS = ("text/csv", "application/json", "application/vnd.apache.parquet")
OTHER_NAMES = {"application/x-parquet": "application/vnd.apache.parquet"}


def asking(accept: str | None) -> Request:
    headers = [] if accept is None else [(b"accept", accept.encode())]
    return Request({"type": "http", "headers": headers})


@pytest.mark.parametrize(
    ("accept", "form"),
    [
        (None, "text/csv"),
        ("", "text/csv"),
        ("*/*", "text/csv"),
        ("text/*", "text/csv"),
        ("text/html, */*;q=0.8", "text/csv"),
        ("application/json", "application/json"),
        ("Application/JSON; charset=utf-8", "application/json"),
        ("application/json, */*", "application/json"),
        ("application/json, text/csv", "text/csv"),
        ("text/csv;q=0.5, application/json", "application/json"),
        ("text/csv;q=0.5, application/json;version=1;q=0.4", "text/csv"),
        ("text/csv;q=0, application/json", "application/json"),
        ("application/x-parquet", "application/vnd.apache.parquet"),
    ],
)
def test_the_form_is_the_one_that_the_client_prefers(accept: str | None, form: str) -> None:
    assert accepted_form(asking(accept), FORMS, OTHER_NAMES) == form


@pytest.mark.parametrize(
    "accept", ["text/html", "image/*", "*/*;q=0", "text/*;q=0, */*", "text/csv;q=0, */*"]
)
def test_a_client_that_accepts_no_form_is_told_which_there_are(accept: str) -> None:
    with pytest.raises(ApiError, match=r"text/csv or application/json or .*, not ") as caught:
        accepted_form(asking(accept), FORMS)
    assert caught.value.status == 406


@pytest.mark.parametrize(
    ("header", "coding"),
    [
        ("", ""),
        ("identity", ""),
        ("gzip, deflate", "gzip"),
        ("gzip, deflate, br, zstd", "zstd"),
        ("zstd;q=0, GZIP;q=0.5", "gzip"),
        ("*", "zstd"),
        ("*;q=0, gzip", "gzip"),
        ("gzip;q=high", ""),
    ],
)
def test_the_coding_is_one_that_is_accepted(header: str, coding: str) -> None:
    assert accepted_coding(header) == coding
