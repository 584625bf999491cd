"""What is typed and does not fit together yet, beside the last design that did."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.design import Design, drive_at, only
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.project import dumps, loads
from kindyna_gui.documents.refusal import Refusal, Texts
from kindyna_gui.labels import name_of


@frozen
class Draft:
    """All that is typed.

    whole     every drive, as typed; no value is outside of its own range
    path      the value typed last, '' where none is
    reasons   path in the whole file, and sentence, of what does not fit together
    """

    whole: Design
    path: str = ""
    reasons: Texts = ()

    def refusal(self, chosen: int) -> Refusal:
        """Path typed last and reasons as the forms of the chosen drive name them."""
        rows = ((*self._own(path, chosen), text) for path, text in self.reasons)
        return Refusal(
            self._own(self.path, chosen)[0], tuple((path, name_of(design, path), text) for path, design, text in rows)
        )

    def _own(self, path: str, chosen: int) -> tuple[str, Design]:
        """The path in the design of the chosen drive, where it leads into that; else in the whole file."""
        own = drive_at(path)
        return (own[1], only(self.whole, chosen)) if own is not None and own[0] == chosen else (path, self.whole)

    def state(self) -> dict[str, Any]:
        """As a plain dictionary of text and lists."""
        return {"design": dumps(self.whole), "path": self.path, "reasons": [list(row) for row in self.reasons]}

    @classmethod
    def from_state(cls, state: Mapping[str, Any]) -> Draft:
        """Raises DesignError where the dictionary holds no design."""
        try:
            reasons = tuple((str(path), str(text)) for path, text in state["reasons"])
            return cls(loads(str(state["design"]), unfinished=True), str(state["path"]), reasons)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError([Fault("draft", str(error), "cannot be read", "what Draft.state() gives")]) from error


__all__ = ["Draft"]
