"""Dataclasses of arrays with the same first axis."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Self

import numpy as np


class Arrays:
    """A dataclass whose fields are all arrays (n, ...)."""

    def only(self, at: np.ndarray) -> Self:
        """The rows ``at``: indices or a mask (n,)."""
        mine: Any = self
        return type(self)(*(getattr(self, f.name)[at] for f in fields(mine)))
