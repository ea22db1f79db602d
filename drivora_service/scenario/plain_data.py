"""Safe reading of text as plain data: bounded in size and depth, with checked keys and values.

Nothing in a text is executed, resolved or opened: YAML tags, anchors and aliases are
rejected, and so are repeated keys, which parsers would silently drop.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any, Literal

import numpy as np
import yaml

from drivora_service.errors import FurtherProblems, InvalidDocument, Problem, further_problems

MAX_DOCUMENT_BYTES = 4 * 1024 * 1024
MAX_YAML_BYTES = 256 * 1024
"""Smaller than for JSON, since YAML is read two orders of magnitude slower."""
MAX_DEPTH = 32
MAX_VALUES = 500_000
MAX_INTEGER = 2**63 - 1
MAX_PROBLEMS = 100
"""Problems that are listed; further ones are counted, where their number is known."""
MAX_LOOKED_AT = 1000
"""Items of a list that are checked one by one where the document has other problems already."""

_STRING = re.compile(r'"(?:[^"\\]++|\\.)*+"?', re.DOTALL)

_TYPE_NAMES: Mapping[type, str] = {
    dict: "an object",
    list: "a list",
    str: "text",
    bool: "a boolean",
    int: "an integer",
    float: "a number",
    type(None): "null",
}


def plain_data(
    data: str | bytes | Mapping[str, Any],
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
    *,
    what: str = "a scenario",
    most_bytes: int = MAX_DOCUMENT_BYTES,
) -> tuple[dict[str, Any], list[Problem]]:
    """Returns the top-level object of a text, or of parsed data, and the problems in it.

    Problems are repeated keys and values that JSON, UTF-8 or the store cannot hold. ``what`` is
    the expected content, for messages; ``most_bytes`` bounds a text of JSON.

    Raises:
        InvalidDocument: The text cannot be read: it is too large, too deep, not in the given
            language, or not an object with text keys.
    """
    if isinstance(data, str | bytes):
        text = decode_text(data, most_bytes if format == "json" else MAX_YAML_BYTES)
        content = _from_json(text) if format == "json" else _from_yaml(text)
    else:
        content = dict(data)
    if not isinstance(content, dict):
        raise refusal("not_an_object", f"found {kind_of(content)}; {what} is one object with keys")
    problems = _odd_values(content)
    if any(problem.code == "odd_key" for problem in problems):
        raise InvalidDocument(
            tuple(p for p in problems if p.code == "odd_key" or isinstance(p, FurtherProblems))
        )
    return content, problems


def pointer(tokens: Iterable[str | int]) -> str:
    """Joins keys and indices to a JSON pointer (RFC 6901)."""
    return "".join(f"/{str(t).replace('~', '~0').replace('/', '~1')}" for t in tokens)


def kind_of(value: object) -> str:
    """Returns the name of a value's JSON type, for messages."""
    return _TYPE_NAMES.get(type(value), type(value).__name__)


def refusal(code: str, message: str) -> InvalidDocument:
    """Returns an error about the document as a whole."""
    return InvalidDocument((Problem(pointer="", code=code, message=message),))


def decode_text(data: str | bytes, limit: int) -> str:
    """Returns the text of at most ``limit`` bytes of UTF-8, without a byte-order mark."""
    if len(data) > limit:
        raise refusal("too_large", f"found {len(data)} bytes; at most {limit} are allowed")
    if isinstance(data, str):
        return data.removeprefix("\ufeff")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refusal(
            "not_utf8", f"found a byte that is not UTF-8 at position {error.start}"
        ) from error


class _RepeatedKeys(dict[Any, Any]):
    """An object with repeated keys."""

    repeated: tuple[Any, ...] = ()


def _object(pairs: list[tuple[Any, Any]]) -> dict[Any, Any]:
    result = dict(pairs)
    if len(result) == len(pairs):
        return result
    marked = _RepeatedKeys(result)
    counts = Counter(key for key, _ in pairs)
    marked.repeated = tuple(key for key, count in counts.items() if count > 1)
    return marked


def _from_json(text: str) -> Any:
    outside = np.frombuffer(_STRING.sub("", text).encode("utf-8", "replace"), np.uint8)
    opened = (outside == ord("[")) | (outside == ord("{"))
    closed = (outside == ord("]")) | (outside == ord("}"))
    depth = np.cumsum(opened.astype(np.int32) - closed)
    if depth.size and depth.max() > MAX_DEPTH:
        raise _too_deep()
    try:
        return json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise refusal(
            "not_json", f"not JSON at line {error.lineno}, column {error.colno}: {error.msg}"
        ) from error
    except ValueError as error:  # an integer of more digits than Python converts
        raise refusal("not_json", f"not JSON: {error}") from error


def _too_deep() -> InvalidDocument:
    return refusal("too_deep", f"found nesting deeper than {MAX_DEPTH} levels")


class _PlainLoader(yaml.CSafeLoader):
    """Safe YAML that keeps repeated keys visible."""


def _construct_object(loader: _PlainLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    pairs = []
    for key_node, value_node in node.value:
        if not isinstance(key_node, yaml.ScalarNode):
            raise yaml.constructor.ConstructorError(
                None, None, "keys must be text", key_node.start_mark
            )
        key = loader.construct_object(key_node, deep=True)
        pairs.append((key, loader.construct_object(value_node, deep=True)))
    return _object(pairs)


_PlainLoader.add_constructor("tag:yaml.org,2002:map", _construct_object)


def _from_yaml(text: str) -> Any:
    try:
        depth = 0
        for event in yaml.parse(text, Loader=_PlainLoader):
            if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
                mark = event.start_mark
                raise refusal(
                    "not_yaml",
                    f"found an anchor or alias{_place(mark)}; write out what it stands for",
                )
            if isinstance(event, yaml.CollectionStartEvent):
                depth += 1
                if depth > MAX_DEPTH:
                    raise _too_deep()
            elif isinstance(event, yaml.CollectionEndEvent):
                depth -= 1
        return yaml.load(text, Loader=_PlainLoader)
    except yaml.YAMLError as error:
        place = _place(getattr(error, "problem_mark", None))
        reason = getattr(error, "problem", None) or getattr(error, "reason", "") or "unreadable"
        raise refusal("not_yaml", f"not YAML{place}: {reason}") from error
    except (ValueError, OverflowError) as error:  # a date or number that does not exist
        raise refusal("not_yaml", f"not YAML: {error}") from error


def _place(mark: Any) -> str:
    return f" at line {mark.line + 1}, column {mark.column + 1}" if mark is not None else ""


def _odd_values(content: Any) -> list[Problem]:
    """Returns the values that JSON, UTF-8 or the store cannot hold; without recursion."""
    problems: list[Problem] = []
    seen = 0
    stack: list[tuple[tuple[str | int, ...], Any]] = [((), content)]
    while stack and len(problems) <= MAX_PROBLEMS:
        place, value = stack.pop()
        children: Iterable[tuple[Any, Any]]
        if isinstance(value, dict):
            children = value.items()
            seen += len(value)
            problems += _odd_keys(place, value)
        elif isinstance(value, list | tuple):
            children = enumerate(value)
            seen += len(value)
        else:
            children = ()
            message = _odd_leaf(value)
            if message:
                problems.append(Problem(pointer=pointer(place), code="odd_value", message=message))
        if seen > MAX_VALUES:
            raise refusal("too_large", f"found more than {MAX_VALUES} values")
        if len(place) > MAX_DEPTH:
            raise _too_deep()
        for key, child in children:
            if not _is_plain(child):
                stack.append(((*place, key), child))
    if len(problems) > MAX_PROBLEMS:
        return [*problems[:MAX_PROBLEMS], further_problems(0, stopped=True)]
    return problems


def _is_plain(value: Any) -> bool:
    """Returns whether a value is neither a container nor odd; fast, as most values are so."""
    kind = type(value)
    if kind is float:
        return math.isfinite(value)
    if kind is str:
        return _is_plain_text(value)
    return kind is bool or value is None or (kind is int and abs(value) <= MAX_INTEGER)


def _is_plain_text(value: str) -> bool:
    return value.isascii() and "\0" not in value


def _odd_keys(place: tuple[str | int, ...], value: Mapping[Any, Any]) -> list[Problem]:
    problems = [
        Problem(
            pointer=pointer((*place, key)),
            code="repeated_key",
            message=f"found key {str(key)[:80]!r} more than once; give it once",
        )
        for key in islice(getattr(value, "repeated", ()), MAX_PROBLEMS + 1)
    ]
    for key in value:
        if len(problems) > MAX_PROBLEMS:
            break
        if type(key) is str and _is_plain_text(key):
            continue
        message = (
            _odd_leaf(key)
            if isinstance(key, str)
            else f"found {kind_of(key)} as a key; keys are text"
        )
        if message:
            problems.append(Problem(pointer=pointer(place), code="odd_key", message=message))
    return problems


def _odd_leaf(value: object) -> str:
    """Returns the problem of a value that is not a container; "" without a problem."""
    if isinstance(value, str):
        if "\0" in value:
            return "found the NUL character; it is not allowed"
        if not value.isascii() and any("\ud800" <= character <= "\udfff" for character in value):
            return "found half a surrogate pair; text must be valid Unicode"
        return ""
    if isinstance(value, bool) or value is None:
        return ""
    if isinstance(value, int):
        return "" if abs(value) <= MAX_INTEGER else "found an integer beyond 64 bits"
    if isinstance(value, float):
        return "" if math.isfinite(value) else f"found {value}; only finite numbers are allowed"
    return f"found {kind_of(value)}; JSON has no such value"
