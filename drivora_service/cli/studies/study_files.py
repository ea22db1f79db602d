"""Study files: YAML or JSON that may name scenario files, folders and patterns."""

from __future__ import annotations

from pathlib import Path

from drivora_service.cli.scenarios.listed_scenarios import (
    ListFile,
    read_list_draft,
    read_list_file,
)
from drivora_service.store.campaigns.study_records import LONGEST_LABEL


def read_study_file(path: Path) -> ListFile:
    """Reads a study file and the scenario files that it names.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON, or a scenario file cannot be read.
    """
    return read_list_file(path, what="a study", name_key="label", longest_name=LONGEST_LABEL)


def read_study_draft(path: Path) -> ListFile:
    """Reads a study file and the scenario files that it names, as far as it can.

    Raises:
        ConfigurationError: The file cannot be read.
        InvalidDocument: It is no YAML or JSON at all.
    """
    return read_list_draft(path, what="a study", name_key="label", longest_name=LONGEST_LABEL)
