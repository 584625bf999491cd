"""Which points of a linkage show their paths, and the paths of a linkage as drawn."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject, Signal

from core.design import Design
from core.design.linkage import FRAME_LINK, Linkage
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism import body_name
from core.mechanism.drawn import traced_points
from core.study import Study
from kindyna_gui.documents.session import Session

PATH_POINTS = 360  # least number of points of a path over the turn


@frozen(eq=False)
class PointPath:
    """Path of a point (n,) [mm], and whether the driver determines it."""

    positions: np.ndarray
    is_driven: bool


class PointPaths(QObject):
    """The points that show their paths: those that trace one, unless the user chooses otherwise.

    Signal: ``changed`` when the user has chosen.
    """

    changed = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self._chosen: set[str] = set()  # points whose path is shown against the rule, or hidden against it
        self._drawn: tuple[Design, frozenset[str], dict[str, PointPath]] | None = None
        session.started.connect(self._chosen.clear)

    def shown(self, linkage: Linkage) -> frozenset[str]:
        """Points of a linkage that show their paths."""
        return traced_points(linkage) ^ (self._chosen & set(path_points(linkage)))

    def is_shown(self, name: str) -> bool:
        """Whether a point shows its path."""
        return name in self.shown(self._session.typed.drive.linkage)

    def toggle(self, name: str) -> None:
        """Show or hide the path of a point."""
        self._chosen ^= {name}
        self.changed.emit()

    def drawn(self) -> dict[str, PointPath]:
        """Return the paths of the linkage as drawn, also of one that is incomplete or has no driver."""
        design = self._session.typed
        names = self.shown(design.drive.linkage)
        if self._drawn is None or self._drawn[:2] != (design, names):
            self._drawn = design, names, self._paths(design, names) if names else {}
        return self._drawn[2]

    def _paths(self, design: Design, names: frozenset[str]) -> dict[str, PointPath]:
        from core.mechanism.unfinished import mobility, movable_part_of  # only an incomplete drawing needs it

        linkage = design.drive.linkage
        try:
            if self._session.incomplete is None:
                paths = {name: path_of(self._session.study, name) for name in names}
                return {name: PointPath(z[:: max(1, z.size // PATH_POINTS)], True) for name, z in paths.items()}
            state = mobility(linkage)
            part = movable_part_of(design, state)
            paths = part.paths(names) if part is not None else {}
        except KindynaError:
            return {}
        driven = {p.name for k in linkage.links if k.number in state.driven for p in k.points}
        return {name: PointPath(path, name in driven) for name, path in paths.items()}


def path_of(study: Study, name: str) -> np.ndarray:
    """Path (n,) [mm] of a moving point of a linkage while its driver passes its turn, or its range. Raises NoSolution."""
    links = study.design.drive.linkage.links
    owner = next(k.number for k in links if k.number != FRAME_LINK and name in k.places)
    path: np.ndarray = study.linkage.bodies[body_name(owner)].position(name) * 1e3
    return path


def path_points(linkage: Linkage) -> tuple[str, ...]:
    """Points of a linkage that can move."""
    fixed = {p.name for k in linkage.links if k.number == FRAME_LINK for p in k.points}
    moving = (p.name for k in linkage.links if k.number != FRAME_LINK for p in k.points)
    return tuple(dict.fromkeys(name for name in moving if name not in fixed))
