"""The base of the shapes of answers."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Schema(BaseModel):
    """A shape of the API: closed, and the same in both directions."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="null")
