"""Reading law files; every mistake is named with its line and column."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.oracles.laws.formula import Implies
from drivora_service.oracles.laws.law import MAX_SUB_VIOLATIONS, Law, LawParameter
from drivora_service.oracles.laws.law_documents import LawDocument, LawFileDocument
from drivora_service.oracles.laws.law_signals import BY_NAME
from drivora_service.oracles.laws.law_tokens import WORDS, FormulaError
from drivora_service.oracles.laws.normal_form import (
    count_sub_violations,
    normal_form,
    sub_violations,
)
from drivora_service.oracles.laws.parsing import Quantity, read_law
from drivora_service.oracles.laws.places import Places
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.oracles.laws.units import read_unit
from drivora_service.scenario.document_problems import in_document_order, structural_problems
from drivora_service.scenario.plain_data import decode_text, plain_data

_MAX_BYTES = 256 * 1024


def read_laws(source: LawSource) -> tuple[Law, ...]:
    """Reads a law file.

    Raises:
        InvalidDocument: It cannot be used; the message of each problem begins with
            ``FILE:LINE:COLUMN``.
    """
    if source.fault:
        raise InvalidDocument((Problem(pointer="", code="unreadable", message=source.fault),))
    content, problems = plain_data(source.data, "yaml", what="a law file")
    places = Places(decode_text(source.data, _MAX_BYTES))
    try:
        document = LawFileDocument.model_validate(content)
    except ValidationError as error:
        known = {problem.pointer for problem in problems}
        problems += [
            problem
            for problem in structural_problems(error, LawFileDocument, content)
            if problem.pointer not in known
        ]
        raise _make_error(source.file, problems, content, places) from error
    laws = []
    digest = hashlib.sha256(source.data).hexdigest()
    names: dict[str, str] = {}
    for index, law in enumerate(document.laws):
        pointer = f"/laws/{index}"
        first = names.setdefault(law.name, pointer)
        if first != pointer:
            message = f"found the law {law.name!r} again (first at {first}); names are unique"
            problems.append(Problem(pointer=f"{pointer}/name", code="repeated", message=message))
        own = list(_parameter_problems(law, pointer))
        problems += own
        if not own:
            try:
                laws.append(_law(law, source.file, digest))
            except FormulaError as error:
                line, column = places.inside(f"{pointer}/formula", error.offset)
                message = f"{source.file}:{line}:{column}: {error}"
                problems.append(
                    Problem(pointer=f"{pointer}/formula", code="formula", message=message)
                )
    if problems:
        raise _make_error(source.file, problems, content, places)
    return tuple(laws)


def _law(document: LawDocument, file: str, digest: str) -> Law:
    quantities = {}
    for name, parameter in document.parameters.items():
        unit = read_unit(parameter.unit)
        assert unit is not None, "units were checked before"
        quantities[name] = Quantity(value=parameter.value, unit=unit)
    formula, used = read_law(document.formula, quantities)
    unused = [name for name in document.parameters if name not in used]
    if unused:
        raise FormulaError(
            f"the formula does not name the {'parameter' if len(unused) == 1 else 'parameters'} "
            f"{', '.join(unused)}; remove what is not needed",
            0,
        )
    count = count_sub_violations(formula)
    if count > MAX_SUB_VIOLATIONS:
        raise FormulaError(
            f"the law can be violated in {count} ways; at most {MAX_SUB_VIOLATIONS} are allowed: "
            "split it into several laws, for instance at an `and`",
            0,
        )
    return Law(
        name=document.name,
        title=document.title,
        source=document.source,
        description=document.description,
        left_out=document.left_out,
        severity=document.severity,
        parameters=tuple(
            LawParameter(name=name, value=one.value, unit=one.unit, meaning=one.meaning)
            for name, one in document.parameters.items()
        ),
        text=" ".join(document.formula.split()).replace("( ", "(").replace(" )", ")"),
        formula=normal_form(formula),
        condition=normal_form(formula.condition) if isinstance(formula, Implies) else None,
        violation=normal_form(formula, negated=True),
        sub_violations=sub_violations(formula),
        file=file,
        sha256=digest,
    )


def _parameter_problems(law: LawDocument, pointer: str) -> Iterator[Problem]:
    for name, parameter in law.parameters.items():
        place = f"{pointer}/parameters/{name}"
        if name in BY_NAME or name in WORDS:
            kind = "signal" if name in BY_NAME else "word of the language"
            message = f"found {name!r}, which is a {kind}; give the parameter another name"
            yield Problem(pointer=place, code="parameter_name", message=message)
        if read_unit(parameter.unit) is None:
            message = (
                f"found the unit {parameter.unit!r}; allowed are m, s and rad, their powers, "
                "products and quotients (m/s, m/s²), and 1"
            )
            yield Problem(pointer=f"{place}/unit", code="unit", message=message)


def _make_error(
    file: str, problems: list[Problem], content: dict[str, Any], places: Places
) -> InvalidDocument:
    """Returns the error of all problems, each with its place."""
    placed = []
    for problem in in_document_order(problems, content):
        if problem.code != "formula":
            line, column = places.of(problem.pointer)
            problem = replace(problem, message=f"{file}:{line}:{column}: {problem.message}")
        placed.append(problem)
    return InvalidDocument(tuple(placed))
