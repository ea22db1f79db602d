"""The provenance of a network: the ``provenance.yaml`` beside every network file."""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from drivora_service.errors import NetworkError

FILE_NAME = "provenance.yaml"


class Provenance(BaseModel):
    """The source of a network and its conversion to a ``.net.xml`` file.

    Attributes:
        title: Name in listings.
        description: Purpose, in a sentence.
        source: Source: a phrase, or the name of the imported file.
        licence: SPDX identifier, or the known facts.
        source_sha256: Hash of the imported file, hexadecimal.
        netconvert: Version of netconvert; None if it was copied.
        options: netconvert's options; empty if a configuration file holds them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str
    description: str
    source: str
    licence: str
    source_sha256: str | None = None
    netconvert: str | None = None
    options: tuple[str, ...] = ()

    def to_yaml(self) -> str:
        """Returns the text of the file."""
        data = self.model_dump(mode="json", exclude_defaults=True)
        return yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=100)


def read_provenance(directory: Path) -> Provenance:
    """Reads the provenance of the network in ``directory``.

    Raises:
        NetworkError: The file is missing or not a provenance.
    """
    path = directory / FILE_NAME
    try:
        return Provenance.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, yaml.YAMLError, ValidationError) as error:
        raise NetworkError(
            f"cannot read {FILE_NAME} of network {directory.name!r}: {error}"
        ) from error
