"""The form and the coding of an answer, as the headers of the request accept them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Literal

from fastapi import Request

from drivora_service.api.problem_details import ApiError

Coding = Literal["", "gzip", "zstd"]
"""Of the content of an answer; "": as it is."""

_ANY = "*/*"


def accepted_form(
    request: Request, forms: Sequence[str], other_names: Mapping[str, str] | None = None
) -> str:
    """Returns the media type of an answer: of those that the client names, the one it prefers.

    The first one is for clients that name none of them but accept it by a range, as `*/*`.

    Args:
        request: The request.
        forms: The media types that the answer can have.
        other_names: Names that clients also use, each with the media type that is meant.

    Raises:
        ApiError: The client accepts none of them (406).
    """
    accept = request.headers.get("accept") or _ANY
    names = {form: form for form in forms} | dict(other_names or {})
    weights = _weights(accept)
    named = {names[name]: weight for name, weight in weights.items() if name in names}
    preferred = max((form for form in forms if named.get(form)), key=named.__getitem__, default="")
    if preferred:
        return preferred
    usual = forms[0]
    ranges = (f"{usual.partition('/')[0]}/*", _ANY)
    if usual not in named and next((weights[name] for name in ranges if name in weights), 0.0):
        return usual
    detail = f"the answer comes as {' or '.join(forms)}, not {accept!r}"
    raise ApiError(HTTPStatus.NOT_ACCEPTABLE, detail)


def accepted_coding(accept_encoding: str) -> Coding:
    """Returns the best coding that a client accepts, by its header; zstd before gzip."""
    weights = _weights(accept_encoding)
    usual = weights.get("*", 0.0)
    if weights.get("zstd", usual) > 0.0:
        return "zstd"
    return "gzip" if weights.get("gzip", usual) > 0.0 else ""


def _weights(header: str) -> dict[str, float]:
    weights: dict[str, float] = {}
    for part in header.lower().split(","):
        name, *parameters = (piece.strip() for piece in part.split(";"))
        weights[name] = min(map(_weight, parameters), default=1.0)
    return weights


def _weight(parameter: str) -> float:
    name, _, value = parameter.partition("=")
    if name.strip() != "q":
        return 1.0
    try:
        return float(value)
    except ValueError:
        return 0.0
