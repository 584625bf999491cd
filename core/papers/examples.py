"""The example files that the claims and figures of the papers are computed of, each studied once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from types import MappingProxyType
from typing import Any

from core.design import Design
from core.project import load
from core.resources import resources
from core.study import Camshaft, Study

SAMPLES = 720  # of a turn
NONE: Mapping[str, Design] = MappingProxyType({})


class Examples:
    """Studies of the examples by the names of their files; ``designs``: others in their places."""

    def __init__(self, designs: Mapping[str, Design] = NONE) -> None:
        self._designs = dict(designs)
        self._made: dict[Hashable, Any] = {}

    def design(self, name: str) -> Design:
        if name not in self._designs:
            self._designs[name] = load(resources() / "examples" / f"{name}.toml")
        return self._designs[name]

    def study(self, name: str) -> Study:
        """Of a design."""
        study: Study = self.once(("study", name), lambda: Study(self.design(name), SAMPLES))
        return study

    def shaft(self, name: str) -> Camshaft[Study]:
        """What all drives of a design do together."""
        return self.study(name).camshaft

    @property
    def made(self) -> frozenset[Hashable]:
        """The keys of what is there already."""
        return frozenset(self._made)

    def once(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """What several claims need, made for the first of them."""
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]
