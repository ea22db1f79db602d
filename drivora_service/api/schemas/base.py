"""What all shapes of answers share."""

from __future__ import annotations

from typing import Generic, TypeVar

from pydantic import BaseModel, ConfigDict, Field

Item = TypeVar("Item")


class Schema(BaseModel):
    """A shape of the API: closed, and the same in both directions."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="null")


class PageOf(Schema, Generic[Item]):
    """Some items of a list, and the token that asks for the next ones."""

    items: tuple[Item, ...]
    next_page_token: str = Field(
        default="", description="Pass as `page_token` to go on; empty at the end."
    )
