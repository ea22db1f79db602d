"""The endpoints, one module a resource."""

from __future__ import annotations

from starlette.convertors import Convertor, register_url_convertor


class _Id(Convertor[str]):
    """An id or name in a path: everything but NUL, and the ``:`` that stands before an action.

    Without it ``GET /jobs/1:cancel`` would ask for a job named ``1:cancel``, rather than with the
    wrong method for an action. NUL is in no id, and PostgreSQL refuses to look for it.
    """

    regex = r"[^/:\x00]+"

    def convert(self, value: str) -> str:
        """Returns the value as it stands."""
        return value

    def to_string(self, value: str) -> str:
        """Returns the value as it stands."""
        return value


register_url_convertor("id", _Id())
