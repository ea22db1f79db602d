"""The genes of stored campaigns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
from tests.studies.computed_study import campaign_content, opened


def test_genes_are_known_again_once_what_was_missing_is_back(
    catalogues: Catalogues, tmp_path: Path
) -> None:
    with opened(tmp_path, catalogues) as study:
        campaign_id = study.create(campaign_content())
        with study.database.read() as transaction:
            record = transaction.campaigns.get(campaign_id)
    spaces = GeneSpaces(catalogues)
    assert spaces.of(replace(record, network_sha256="another network"), 0) is None
    known = spaces.of(record, 0)
    assert known is not None
    assert spaces.of(record, 0) is known
