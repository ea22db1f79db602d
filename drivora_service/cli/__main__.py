"""``python -m drivora_service.cli`` is ``drivora``."""

from __future__ import annotations

from drivora_service.cli.main import app

if __name__ == "__main__":
    app()
