"""Names and notes that users give: their check, for types of documents and requests.

A name is one line without acting characters (see ``visible_text``); a note may have several lines.
Documents of older versions may have other names: :func:`read_stored` accepts those.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeVar

from pydantic import AfterValidator, BaseModel, ValidationInfo
from pydantic_core import PydanticCustomError

from drivora_service.visible_text import describe_acting_character

_STORED: Mapping[str, bool] = MappingProxyType({"drivora_is_stored": True})

M = TypeVar("M", bound=BaseModel)


def describe_name_fault(name: str) -> str:
    """Returns what a name has that no name may have, and what is allowed; "" if nothing."""
    found = describe_acting_character(name)
    return f"found {found}; {_ALLOWED_IN_NAMES}" if found else ""


def read_stored(model: type[M], content: object) -> M:
    """Reads a stored document, whose names may be of a version that did not check them.

    Raises:
        ValidationError: It is no such document.
    """
    return model.model_validate(content, context=dict(_STORED))


def stored_context(*, is_stored: bool) -> dict[str, Any] | None:
    """Returns the context of pydantic's validation that accepts stored names; ``None``: given."""
    return dict(_STORED) if is_stored else None


_ALLOWED_IN_NAMES = (
    "a name is one line, without control characters and without characters that set the direction "
    "of text or have no width: remove it"
)
_ALLOWED_IN_NOTES = (
    "line feeds and tabs are allowed, other control characters are not, nor are characters that "
    "set the direction of text or have no width: remove it"
)


def _check_name(name: str, info: ValidationInfo) -> str:
    return _check(name, info, describe_acting_character(name), _ALLOWED_IN_NAMES)


def _check_note(note: str, info: ValidationInfo) -> str:
    # Browsers send the lines of a text field with carriage returns.
    note = note.replace("\r\n", "\n")
    found = describe_acting_character(note, has_lines=True)
    return _check(note, info, found, _ALLOWED_IN_NOTES)


def _check(text: str, info: ValidationInfo, found: str, allowed: str) -> str:
    if found and not (
        isinstance(info.context, Mapping) and info.context.items() >= _STORED.items()
    ):
        raise PydanticCustomError(
            "acting_character", "found {found}; {allowed}", {"found": found, "allowed": allowed}
        )
    return text


CHECKED_NAME = AfterValidator(_check_name)
"""Makes a text a name, label or title; stands behind the bounds in ``Annotated[str, …]``."""

CHECKED_NOTE = AfterValidator(_check_note)
"""Makes a text a note, which may have several lines; stands behind the bounds likewise."""
