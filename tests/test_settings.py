from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.errors import ConfigurationError
from drivora_service.settings import Settings, load_settings


def test_options_win_over_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRIVORA_WORKERS", "3")
    monkeypatch.setenv("DRIVORA_PORT", "9000")
    settings = load_settings(workers=5, port=None)
    assert (settings.workers, settings.port) == (5, 9000)


def test_everything_lies_in_the_data_folder(tmp_path: Path) -> None:
    settings = load_settings(data_dir=tmp_path)
    assert settings.resolved_database_url == f"sqlite:///{tmp_path}/drivora.sqlite3"
    places = (
        settings.traces_dir,
        settings.imported_networks_dir,
        settings.tokens_path,
        settings.agents_folder,
    )
    assert all(tmp_path in place.parents for place in places)


def test_every_wrong_value_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRIVORA_WORKERS", "none")
    monkeypatch.setenv("DRIVORA_MAX_BODY_MB", "-1")
    with pytest.raises(ConfigurationError) as wrong:
        load_settings()
    assert "DRIVORA_WORKERS" in str(wrong.value)
    assert "DRIVORA_MAX_BODY_MB" in str(wrong.value)


def test_a_limit_of_memory_that_no_system_takes_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # `RLIMIT_DATA` counts bytes in 63 bits.
    monkeypatch.setenv("DRIVORA_CAMPAIGN_MEMORY_MB", str(1 << 43))
    with pytest.raises(ConfigurationError, match="DRIVORA_CAMPAIGN_MEMORY_MB"):
        load_settings()


@pytest.mark.parametrize(
    ("host", "local"),
    [
        ("127.0.0.1", True),
        ("127.8.8.8", True),
        ("::1", True),
        ("localhost", True),
        ("0.0.0.0", False),
        ("::", False),
        ("10.0.0.1", False),
        ("example.org", False),
    ],
)
def test_loopback(host: str, local: bool) -> None:
    assert load_settings(host=host).listens_on_loopback is local


def test_every_setting_is_documented(repository: Path) -> None:
    reference = (repository / "docs" / "reference" / "cli.md").read_text()
    for name in Settings.model_fields:
        assert f"`DRIVORA_{name.upper()}`" in reference


def test_a_password_in_the_address_of_the_database_is_not_shown() -> None:
    settings = Settings(database_url="postgresql+psycopg://drivora:secret@db/drivora")
    assert settings.resolved_database_url.endswith(":secret@db/drivora")
    assert "secret" not in f"{settings} {settings!r}"
