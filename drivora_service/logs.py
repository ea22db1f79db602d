"""The format of log lines: text for a terminal, or one JSON object a line."""

from __future__ import annotations

import io
import logging
import sys
from typing import Literal, TextIO

import structlog

from drivora_service.visible_text import visible_text

_LOGGER_OF_PLUGINS = "alembic.runtime.plugins"
"""A logger that lists its own parts whenever a database is migrated."""


def configure_logs(
    *, form: Literal["console", "json"] = "console", level: str = "info", colors: bool | None = None
) -> None:
    """Sends structlog's and the standard library's lines through one chain to standard error.

    Args:
        form: ``console`` for text, ``json`` for programs.
        level: Least important level that is written.
        colors: Whether console lines are coloured; ``None``: if standard error is a terminal.
    """
    shared: list[structlog.typing.Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.stdlib.add_logger_name,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
        structlog.stdlib.ExtraAdder(),
    ]
    renderer: structlog.typing.Processor
    if form == "json":
        renderer = structlog.processors.JSONRenderer()
        last: list[structlog.typing.Processor] = [structlog.processors.format_exc_info]
    else:
        wanted = sys.stderr.isatty() if colors is None else colors
        # The default also prints the values of variables, tokens among them.
        renderer = structlog.dev.ConsoleRenderer(
            colors=wanted, exception_formatter=_write_traceback
        )
        last = [_make_visible]
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared,
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                _drop_colored_copy,
                *last,
                renderer,
            ],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(level.upper())
    logging.getLogger(_LOGGER_OF_PLUGINS).setLevel("WARNING")
    structlog.configure(
        processors=[
            structlog.stdlib.filter_by_level,
            *shared[:4],
            structlog.stdlib.ProcessorFormatter.wrap_for_formatter,
        ],
        wrapper_class=structlog.stdlib.BoundLogger,
        logger_factory=structlog.stdlib.LoggerFactory(),
        # Few lines are written, and a cached logger would keep an earlier configuration.
        cache_logger_on_first_use=False,
    )


def _write_traceback(log: TextIO, error: structlog.typing.ExcInfo) -> None:
    # Its messages may be of agents and plug-ins.
    text = io.StringIO()
    structlog.dev.plain_traceback(text, error)
    log.write(visible_text(text.getvalue(), has_lines=True))


_OF_LINES = ("exception", "stack")
"""Fields whose values have several lines: tracebacks."""


def _make_visible(
    _logger: object, _method: str, event: structlog.typing.EventDict
) -> structlog.typing.EventDict:
    """Makes what would act on a terminal visible; a value cannot begin a line of its own."""
    return {
        key: visible_text(value, has_lines=key in _OF_LINES) if isinstance(value, str) else value
        for key, value in event.items()
    }


def _drop_colored_copy(
    _logger: object, _method: str, event: structlog.typing.EventDict
) -> structlog.typing.EventDict:
    """Removes uvicorn's coloured copy of the message."""
    event.pop("color_message", None)
    return event
