"""One table of a file into one flat part of a design, told by the metadata of its fields; what is wrong is noted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING as NO_DEFAULT
from dataclasses import Field, fields
from functools import partial
from typing import Any, TypeVar

from core.design import Info, info_of, split_unit
from core.errors import Fault
from core.project.hooks import NO_NUMBER, NO_WORD
from core.project.telling import missing, spelled, unknown_key

P = TypeVar("P")


class Table:
    """A table at its path. Entries are taken out one by one; ``rest`` tells those that nobody took.

    What cannot be read is NO_NUMBER or NO_WORD, of which no rule speaks.
    """

    def __init__(self, at: Any, path: str, found: list[Fault]) -> None:
        self.path, self.found = path, found
        self.is_table = isinstance(at, Mapping)
        self.entries: dict[str, Any] = dict(at) if self.is_table else {}
        if not self.is_table:
            self.tell("", at, "must be a table")
        self._known: list[str] = []

    def tell(self, key: str, value: Any, problem: str, allowed: str = "") -> None:
        """Note a fault at one of its keys, or of the table itself."""
        self.found.append(Fault(f"{self.path}.{key}" if key else self.path, value, problem, allowed))

    def take(self, key: str, read: Callable[[Any], Any], default: Any, allowed: str = "") -> Any:
        """An entry by its reader; where it is missing the default, or NO_DEFAULT's fault and NO_NUMBER."""
        self._known.append(key)
        if key in self.entries:
            return read(self.entries[key])
        if default is not NO_DEFAULT:
            return default
        if self.is_table:
            self.found.append(missing(f"{self.path}.{key}", allowed))
        return NO_NUMBER

    def number(self, key: str, value: Any, info: Info) -> float:
        """A number, whole where the field asks for it."""
        allowed = info.allowed(split_unit(key)[1])
        if isinstance(value, bool) or not isinstance(value, int if info.whole else int | float):
            self.tell(key, value, "must be a whole number" if info.whole else "must be a number", allowed)
            return NO_NUMBER
        try:
            return value if info.whole else float(value)
        except OverflowError:
            self.tell(key, value, "too large for a number", allowed)
            return NO_NUMBER

    def text(self, key: str, value: Any, allowed: str = "") -> str:
        if isinstance(value, str):
            return value
        self.tell(key, value, "must be text", allowed)
        return NO_WORD

    def pair(self, key: str, info: Info, value: Any) -> tuple[float, float]:
        """``[x, y]``."""
        if not isinstance(value, list | tuple) or len(value) != 2:
            self.tell(key, value, "must be two numbers", "[x, y]")
            return NO_NUMBER, NO_NUMBER
        x, y = (self.number(key, v, info) for v in value)
        return x, y

    def rows(self, key: str) -> Iterator[Table]:
        """The tables of a list; none where it is absent."""
        rows = self.take(key, lambda value: value, ())
        if not isinstance(rows, list | tuple):
            self.tell(key, rows, "must be a list of tables", f"[[{self.path}.{key}]]")
            rows = ()
        for i, row in enumerate(rows):
            yield Table(row, f"{self.path}.{key}[{i}]", self.found)

    def part(self, part: type[P], pairs: Mapping[str, tuple[str, str]], given: Mapping[str, Any]) -> P:
        """The part, its fields by their metadata; pairs: key -> the two fields it holds; given: what is read already."""
        values = dict(given)
        paired = {name for names in pairs.values() for name in names}
        infos = {f.name: f for f in fields(part)}  # type: ignore[arg-type]
        for key, (x, y) in pairs.items():
            info = info_of(infos[x])
            assert info is not None
            values[x], values[y] = self.take(key, partial(self.pair, key, info), (infos[x].default, infos[y].default))
        for name, field in infos.items():
            if name not in values and name not in paired:
                values[name] = self._field(field)
        self.rest()
        return part(**values)

    def _field(self, field: Field[Any]) -> Any:
        info, name = info_of(field), field.name
        if info is None or info.choices:
            allowed = " | ".join(info.choices) if info else "the name of a point"
            found = self.take(name, lambda value: self.text(name, value, allowed), field.default, allowed)
            return NO_WORD if found is NO_NUMBER else found
        return self.take(
            name, lambda value: self.number(name, value, info), field.default, info.allowed(split_unit(name)[1])
        )

    def rest(self) -> None:
        """Tell the entries that nobody took."""
        for key in sorted((k for k in self.entries if k not in self._known), key=str):
            fault = unknown_key(f"{self.path}.{spelled(key)}", key, self.entries[key], self._known)
            self.found.append(fault)
