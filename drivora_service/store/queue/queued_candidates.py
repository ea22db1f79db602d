"""Candidates of searches in the queue: their genes before, and what they decode to after a run.

A run of a candidate has the seed scenario of its space as its document until it ends.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace
from typing import Any

from drivora_service.runs.adversary import AdversarySource
from drivora_service.runs.candidate import Candidate, CandidateSource, Reference, SpaceSource
from drivora_service.shapes import adapter, to_json


def source_to_json(source: CandidateSource) -> str:
    """Writes genes and their space, with the hash of its seed scenario in place of the scenario."""
    content: dict[str, Any] = {
        "seed_sha256": hashlib.sha256(source.space.seed.encode()).hexdigest(),
        "options": source.space.options,
        "values": source.values,
    }
    if source.reference is not None:
        content["reference"] = source.reference.paths
    if source.adversary is not None:
        content["adversary"] = asdict(source.adversary)
    return json.dumps(content)


def without_policy(text: str) -> str:
    """Returns what :func:`source_to_json` wrote with a hash in place of the adversary's policy.

    A policy is large, and is not needed once the run has ended.
    """
    content = json.loads(text)
    adversary = content.get("adversary")
    if adversary is None or "policy" not in adversary:
        return text
    policy = adversary.pop("policy")
    adversary["policy_sha256"] = hashlib.sha256(policy.encode()).hexdigest()
    return json.dumps(content)


def source_from_json(text: str, seed: str) -> CandidateSource:
    """Reads what :func:`source_to_json` wrote.

    Args:
        text: The JSON text.
        seed: Canonical JSON text of the seed scenario.
    """
    content = json.loads(text)
    paths = content.get("reference")
    adversary = content.get("adversary")
    return CandidateSource(
        space=SpaceSource(seed=seed, options=content["options"]),
        values=tuple(content["values"]),
        reference=None
        if paths is None
        else Reference(paths=tuple(tuple(map(tuple, path)) for path in paths)),
        adversary=None if adversary is None else AdversarySource(**adversary),
    )


def candidate_to_json(candidate: Candidate) -> str:
    """Writes a candidate without its document, which is stored as the document of its run."""
    return to_json(Candidate, replace(candidate, document="")).decode()


def candidate_from_json(text: str, document: str) -> Candidate:
    """Reads what :func:`candidate_to_json` wrote.

    Args:
        text: The JSON text.
        document: The document of the run.
    """
    candidate: Candidate = adapter(Candidate).validate_json(text)
    return candidate if candidate.problem else replace(candidate, document=document)
