"""``python -m drivora_service.cli`` is ``drivora``."""

from __future__ import annotations

from drivora_service.cli.main import app

if __name__ == "__main__":
    try:
        app()
    finally:
        # Python started with -m ends with the signal, whatever the exit code, if the last text that
        # was run as code met an interrupt (a frozen dataclass of a module imported then, say).
        exec("")
