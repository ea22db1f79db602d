"""The place of an exception in code that is not Drivora's."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from drivora_service.foreign_errors import describe_exception


def describe_import(name: str) -> str:
    with pytest.raises(Exception) as raised:  # noqa: PT011 # each module raises another
        importlib.import_module(name)
    # Without the place of this function, which is that of no plug-in.
    return describe_exception(raised.value.with_traceback(raised.tb.tb_next))


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path


def test_the_line_of_a_module_that_cannot_be_imported(site: Path) -> None:
    file = site / "ads_with_a_missing_library.py"
    file.write_text('"""An ADS."""\n\nimport no_such_library\n')
    assert describe_import(file.stem) == (
        f"ModuleNotFoundError: No module named 'no_such_library' ({file}, line 3)"
    )


def test_the_line_of_a_syntax_error(site: Path) -> None:
    file = site / "ads_that_is_no_python.py"
    file.write_text("x = 1\ndef control(:\n")
    assert describe_import(file.stem) == f"SyntaxError: invalid syntax ({file}, line 2)"


def test_the_line_in_the_package_and_not_in_a_library_that_it_calls(site: Path) -> None:
    (site / "some_library_that_raises.py").write_text("def read():\n    raise ValueError('odd')\n")
    package = site / "ads_in_a_package"
    package.mkdir()
    (package / "__init__.py").write_text("from ads_in_a_package import inner\n")
    inner = package / "inner.py"
    inner.write_text("import some_library_that_raises\n\n\nsome_library_that_raises.read()\n")
    assert describe_import(package.name) == f"ValueError: odd ({inner}, line 4)"


def test_an_exception_that_no_foreign_code_raised_has_no_place() -> None:
    assert describe_exception(ValueError("odd")) == "ValueError: odd"
