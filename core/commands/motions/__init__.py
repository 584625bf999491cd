"""Commands that begin a design with its motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from core.design import Design


def begin(arguments: Any, make: Callable[[Any], Design]) -> int:
    """What is wanted as a design file, and on the terminal its peaks; the exit code."""
    from core.commands import DONE
    from core.output.cycle import begun_text
    from core.project import save
    from core.requests import require

    require(arguments.wanted)
    design = make(arguments.wanted)
    save(design, arguments.out)
    print(begun_text(design))
    return DONE
