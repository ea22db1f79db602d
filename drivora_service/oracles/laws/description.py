"""What a traffic law says about itself, as built-in oracles do."""

from __future__ import annotations

from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.oracle_descriptions import (
    SHARE,
    OracleDescription,
    ThresholdDescription,
    ViolatedBy,
)


def law_description(law: Law) -> OracleDescription:
    """Returns the description of a law; what it measures is its robustness."""
    return OracleDescription(
        name=law.name,
        definition=law.description,
        unit=SHARE,
        violated_by=ViolatedBy.BELOW,
        thresholds=tuple(
            ThresholdDescription(
                name=parameter.name,
                unit=parameter.unit,
                meaning=parameter.meaning,
                source=law.source,
            )
            for parameter in law.parameters
        ),
        source=law.source,
    )
