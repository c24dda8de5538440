"""What all parts of a case share."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

__all__ = ["Part"]


class Part(BaseModel):
    """Base of all parts of a case: frozen, keys that are not known are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)
