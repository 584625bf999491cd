"""The rule of room: which docks of a task share a side and which are tabs, so that none is below its least size.

Sizes in, positions and sizes out: nothing here knows a widget. All sizes are in pixels.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from core.frozen import frozen
from kindyna_gui.window.docks import ANY_HEIGHT, COLUMNS, LEFT, RIGHT, ROWS, Need
from kindyna_gui.window.tasks import INSPECTOR, SEPARATOR, Area, Task

HEAD = 26  # height of a title, or of the tabs in its place
NEAR = 6  # by which the parameters may differ from their width
FORMS = "parameters"

Names = tuple[str, ...]


@frozen
class PlacedGroup:
    """Docks in tabs at one position of a side.

    Attributes
    ----------
    index : int
        Position, by its number in the groups of the task.
    names : tuple of str
    front : str
        The dock in front.
    length : int
        Height in a column at the left or right, width in a row above or below the middle; with title or tabs.
    """

    index: int
    area: Area
    names: Names
    front: str
    length: int


@frozen
class Plan:
    """Positions and sizes of all open docks.

    Attributes
    ----------
    task : Task
        As it is for the width of the window.
    names : tuple of str
        Open docks, with those for which there is no room.
    groups : tuple of PlacedGroup
    extents : Mapping of Area to int
        Width of the columns, height of the rows.
    fits : bool
        Whether nothing is below its least size.
    called : str
        Dock or page that was called.
    size, page : tuple of int
        Size for the docks and the middle, and least size of the middle.
    """

    task: Task
    names: Names
    groups: tuple[PlacedGroup, ...]
    extents: Mapping[Area, int]
    fits: bool
    called: str = ""
    size: tuple[int, int] = (0, 0)
    page: tuple[int, int] = (0, 0)

    @property
    def fronts(self) -> tuple[str, ...]:
        """The docks in front."""
        return tuple(group.front for group in self.groups)

    @property
    def sizes(self) -> dict[str, tuple[int, int]]:
        """Width and height of each dock, with its title or tabs."""
        return {
            name: (self.extents[g.area], g.length) if g.area in COLUMNS else (g.length, self.extents[g.area])
            for g in self.groups
            for name in g.names
        }


def plan_docks(
    task: Task,
    needs: Mapping[str, Need],
    page: tuple[int, int],
    size: tuple[int, int],
    opened: Sequence[str],
    *,
    in_front: Collection[str] = (),
    called: str = "",
    forms: int = INSPECTOR,
    before: Plan | None = None,
) -> Plan:
    """Return positions and sizes of the open docks of a task.

    A dock stands in its group of the task. If that leaves it, or another, below its least size, it becomes a tab of the
    nearest group that has room, last of the group of the large view. Where none has, it is left out, unless it is called.

    Parameters
    ----------
    task : Task
        As it is for a window of this size.
    needs : Mapping of str to Need
        Least sizes of the docks.
    page : tuple of int
        Least size of the middle.
    size : tuple of int
        Width and height for the docks and the middle.
    opened : sequence of str
        Open docks; among equals the earlier one is placed first.
    in_front : collection of str
        Docks now in front of their tabs, which stay there.
    called : str
        Dock or page that the user has just called; empty: none.
    forms : int
        Width of the parameters.
    before : Plan, optional
        The present plan. Its docks stay in their groups as long as they have room there, where nothing was opened, closed
        or called since and the window and its middle have the same size.
    """
    return _Room(task, needs, page, size, forms).plan(opened, in_front, called, before)


class _Room:
    """One window size and task; ``placed`` are the names at each group of the task."""

    def __init__(
        self, task: Task, needs: Mapping[str, Need], page: tuple[int, int], size: tuple[int, int], forms: int
    ) -> None:
        self._task, self._needs, self._page, self._size, self._forms = task, needs, page, size, forms
        self._homes = {name: index for index, (_, names) in enumerate(task.all_docks) for name in names}

    def plan(self, opened: Sequence[str], in_front: Collection[str], called: str, before: Plan | None) -> Plan:
        placed = self._kept(before, opened, called) or self._placed_anew(opened, in_front, called)
        extents = {**self._widths(placed), **self._heights(placed)}
        groups: list[PlacedGroup] = []
        for area in (*COLUMNS, *ROWS):
            indices = self._indices(placed, area)
            for index, length in zip(indices, self._lengths(placed, area, extents), strict=True):
                names = placed[index]
                front = called if called in names else next((n for n in names if n in in_front), names[0])
                groups.append(PlacedGroup(index, area, self._in_order(names, index), front, length))
        fits = self._fits(placed, False)
        return Plan(self._task, tuple(opened), tuple(groups), extents, fits, called, self._size, self._page)

    def _kept(self, before: Plan | None, opened: Sequence[str], called: str) -> list[Names]:
        """Names at each group as before; empty where they have to be placed anew."""
        now = (self._task, {*opened}, called, self._size, self._page)
        if before is None or now != (before.task, {*before.names}, before.called, before.size, before.page):
            return []
        placed: list[Names] = [() for _ in self._task.groups]
        for group in before.groups:
            placed[group.index] = group.names
        has_all = {*opened} == {name for names in placed for name in names}
        return placed if has_all and self._fits(placed, False) else []

    def _placed_anew(self, opened: Sequence[str], in_front: Collection[str], called: str) -> list[Names]:
        """Names at each group, with room for what is called."""
        large = self._task.large
        firsts = (FORMS, large) if called and called not in self._homes else (large, FORMS)
        behind = sorted(opened, key=lambda name: name not in in_front)
        for order in ((*firsts, *in_front, called, *behind), (*firsts, called, *behind)):
            placed = self._placed([name for name in dict.fromkeys(order) if name in opened], called)
            if self._fits(placed, False) and (called not in self._homes or any(called in names for names in placed)):
                break  # else what is in front has to make room for what is called
        return placed

    def _in_order(self, names: Names, index: int) -> Names:
        """Names of a group in the order of the task, those at home first: no tab moves when another view is called."""
        order = list(self._homes)
        return tuple(sorted(names, key=lambda name: (self._homes[name] != index, order.index(name))))

    def _placed(self, order: Sequence[str], called: str) -> list[Names]:
        """Names at each group, placed in this order."""
        placed: list[Names] = [() for _ in self._task.groups]
        room_for_tabs = (False,) if self._task.by_hand else (True, False)  # all names of tabs in sight, if possible
        for name in order:
            trials = [self._with(placed, index, name) for index in self._positions(name, placed)]
            fitting = (trial for tabs in room_for_tabs for trial in trials if self._fits(trial, tabs))
            is_needed = name in (FORMS, called) or not self._fits(placed, False)
            placed = next(fitting, trials[0] if is_needed else placed)
        return placed

    @staticmethod
    def _with(placed: list[Names], index: int, name: str) -> list[Names]:
        return [(*names, name) if number == index else names for number, names in enumerate(placed)]

    def _positions(self, name: str, placed: list[Names]) -> list[int]:
        """Groups for a dock: its own, those of the same side, the others; the one of the large view last."""
        home, groups = self._homes[name], self._task.groups

        def distance(index: int) -> tuple[bool, bool, int]:
            other_side = groups[index].area != groups[home].area
            return index != home and self._task.large in placed[index], other_side, abs(index - home)

        return sorted(range(len(groups)), key=distance)

    # -- least sizes ------------------------------------------------------------------------------------------

    def _indices(self, placed: list[Names], area: Area) -> list[int]:
        return [i for i, group in enumerate(self._task.groups) if group.area == area and placed[i]]

    def _least(self, names: Names, area: Area, with_tabs: bool = False) -> tuple[int, int]:
        """Least size of a group across its side and along it."""
        needs = [self._needs[name] for name in names]
        tabs = sum(need.tab for need in needs) if with_tabs and len(needs) > 1 else 0
        width = max(tabs, *(need.width for need in needs))
        height = HEAD + max(need.height_at(area) for need in needs)
        return (width, height) if area in COLUMNS else (height, width)

    def _side(self, placed: list[Names], area: Area) -> tuple[int, int]:
        """Least size of a side across and along; 0, 0 where it is empty."""
        least = [self._least(placed[index], area) for index in self._indices(placed, area)]
        gaps = SEPARATOR * max(len(least) - 1, 0)
        across = max((size for size, _ in least), default=0)
        return self._forms if self._has_forms(placed, area) else across, sum(size for _, size in least) + gaps

    def _has_forms(self, placed: list[Names], area: Area) -> bool:
        return area in COLUMNS and any(FORMS in placed[index] for index in self._indices(placed, area))

    def _middle(self, placed: list[Names]) -> int:
        """Least width of the middle with the rows above and below it."""
        forms = self._forms if self._forms_in_row(placed) else 0
        return max(self._page[0], forms, *(self._side(placed, area)[1] for area in ROWS))

    def _forms_in_row(self, placed: list[Names]) -> bool:
        """Whether the width of the middle is that of the parameters."""
        return any(FORMS in placed[index] for area in ROWS for index in self._indices(placed, area))

    def _fits(self, placed: list[Names], with_tabs: bool) -> bool:
        width, height = self._size
        sides = {area: self._side(placed, area) for area in (*COLUMNS, *ROWS)}
        columns = [across for area in COLUMNS if (across := sides[area][0])]
        rows = [across for area in ROWS if (across := sides[area][0])]
        for area in COLUMNS:
            wide = max((self._least(placed[i], area, with_tabs)[0] for i in self._indices(placed, area)), default=0)
            if wide > sides[area][0]:  # the parameters stand there
                return False
        return (
            self._are_forms_in_place(placed)
            and sum(columns) + self._middle(placed) + SEPARATOR * len(columns) <= width
            and sum(rows) + self._page[1] + SEPARATOR * len(rows) <= height
            and all(sides[area][1] <= height for area in COLUMNS)
        )

    def _are_forms_in_place(self, placed: list[Names]) -> bool:
        """Whether the parameters are at the right of the window, and as wide as in every task, or where the user put them."""
        if self._task.by_hand:
            return True
        if not self._forms_in_row(placed):
            return not self._has_forms(placed, LEFT)
        is_at_edge = self._indices(placed, LEFT) and not self._indices(placed, RIGHT)
        return bool(is_at_edge) and self._middle(placed) <= self._forms + NEAR

    # -- sizes ------------------------------------------------------------------------------------------------

    def _widths(self, placed: list[Names]) -> dict[Area, int]:
        return self._extents(placed, COLUMNS, self._size[0], self._middle(placed))

    def _heights(self, placed: list[Names]) -> dict[Area, int]:
        return self._extents(placed, ROWS, self._size[1], self._page[1])

    def _extents(self, placed: list[Names], areas: tuple[Area, Area], total: int, middle: int) -> dict[Area, int]:
        """Size across two sides: that of the task, but not below the least of the side, the other side or the middle."""
        least = {area: across for area in areas if (across := self._side(placed, area)[0])}
        room = total - middle - SEPARATOR * len(least)
        extents: dict[Area, int] = {}
        for area, across in least.items():
            most = room - sum(size for other, size in {**least, **extents}.items() if other != area)
            part = self._task.sides.get(area)
            default = across if part is None or self._has_forms(placed, area) else part.size(total)
            if area in ROWS:
                default = min(default, HEAD + self._most(placed, area))
            extents[area] = max(across, min(default, most))
        return extents

    def _most(self, placed: list[Names], area: Area) -> int:
        """Largest height that a row needs."""
        indices = self._indices(placed, area)
        alone = len(indices) == 1 and len(placed[indices[0]]) == 1
        return self._needs[placed[indices[0]][0]].most if alone else ANY_HEIGHT

    def _lengths(self, placed: list[Names], area: Area, extents: Mapping[Area, int]) -> list[int]:
        """Sizes of the groups along a side, in the proportions of the task."""
        indices = self._indices(placed, area)
        total = self._size[1]
        if area in ROWS:
            columns = [extents[column] + SEPARATOR for column in COLUMNS if column in extents]
            total = self._size[0] - sum(columns)
        least = [self._least(placed[index], area)[1] for index in indices]
        most = [
            HEAD + self._needs[placed[index][0]].most if area in COLUMNS and len(placed[index]) == 1 else ANY_HEIGHT
            for index in indices
        ]
        parts = [self._task.groups[index].part for index in indices]
        return share(total - SEPARATOR * max(len(indices) - 1, 0), parts, least, most)


def share(total: int, parts: Sequence[float], least: Sequence[int], most: Sequence[int]) -> list[int]:
    """Divide a length in proportion to ``parts``, each within its limits; what rounding leaves goes to the one with most room."""
    sizes: dict[int, int] = {}
    while len(sizes) < len(parts):
        free = [i for i in range(len(parts)) if i not in sizes]
        rest, all_parts = total - sum(sizes.values()), sum(parts[i] for i in free)
        wanted = {i: round(rest * parts[i] / all_parts) for i in free}
        below = {i: least[i] for i in free if wanted[i] < least[i]}
        above = {i: most[i] for i in free if wanted[i] > most[i]}
        sizes.update(below or above or wanted)
    if sizes:
        sizes[max(sizes, key=lambda i: sizes[i] - least[i])] += total - sum(sizes.values())
    return [max(sizes[i], 1) for i in range(len(parts))]


__all__ = ["FORMS", "HEAD", "PlacedGroup", "Plan", "plan_docks", "share"]
