"""What ``check`` finds in the machine at hand: an answer adds nothing to it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cache

from core.design import Design
from core.errors import NoAnswer
from core.findings import ERROR, NOTE, Finding
from core.study import Study, findings_of

Put = Callable[[Design], Design]
"""The design of one drive -> the machine that it belongs to."""
SAME = 1e-9  # of a value, to which it is the last one that serves ...
NEAR = 1e-4  # ... and where only notes stand against the next one
UNEVEN = "speed-fluctuates"
ENLARGED = 1.5  # times its size: so much may a flywheel grow that goes into the machine with the answer
Found = Mapping[tuple[str, str], Finding]


def alone(design: Design) -> Design:
    """A design that is the whole machine."""
    return design


class FindingsCheck:
    """The findings of the machine that a design belongs to.

    machine  the design of one drive -> the whole; waived: codes that a search may bring, since their limits were stated in it
    notes    whether a note counts, too
    noted    notes, and nothing graver, stood against a design
    """

    def __init__(self, design: Design, machine: Put = alone, waived: Collection[str] = (), notes: bool = True) -> None:
        self._machine, self._waived, self._notes, self._suspect = machine, frozenset(waived), notes, ""
        self.noted = False
        before = Study(machine(design))
        self._stages = before.stages
        self._before = cache(lambda stage: _known(before, stage))

    @property
    def part(self) -> float:
        """To which an answer is sought."""
        return NEAR if self.noted else SAME

    def new(self, made: Design, quick: bool = False) -> tuple[str, ...]:
        """What would be found with another design in its place and is not now, in words, of the first stage in which something is. Where
        there is no answer now: its errors. quick: in the stage only in which something was found last."""
        study = Study(self._machine(made))
        order = sorted(self._stages, key=lambda stage: stage != self._suspect)
        for stage in order[:1] if quick else order:
            before = self._before(stage)
            try:
                found = _found(study, stage)
            except NoAnswer as error:
                return (str(error).partition("\n")[0],)
            new = [
                each
                for key, each in found.items()
                if each.code not in self._waived
                and not _mended(each)
                and (each.severity == ERROR if before is None else key not in before)
                and (self._notes or each.severity != NOTE)
            ]
            if new:
                self._suspect = stage
                self.noted |= all(each.severity == NOTE for each in new)
                return tuple(_words(each) for each in new)
        return ()


def uneven(machine: Design) -> bool:
    """Whether its speed is found to fluctuate by more than wanted."""
    study = Study(machine)
    return "dynamics" in study.stages and any(code == UNEVEN for code, _ in _known(study, "dynamics") or ())


def _found(study: Study, stage: str) -> Found:
    """By code and field. Raises NoAnswer."""
    return {(each.code, each.field): each for each in findings_of(study, (stage,))}


def _known(study: Study, stage: str) -> Found | None:
    """None where the machine has no answer there, or one of its drives has none at all."""
    try:
        found = _found(study, stage)
    except NoAnswer:
        return None
    return None if any(code == "no-drive" for code, _ in found) else found


def _mended(finding: Finding) -> bool:
    """Whether a flywheel not much larger than the fitted one keeps the speed even."""
    percent, wanted = (finding.values.get(name) for name in ("percent", "wanted_percent"))
    return (
        finding.code == UNEVEN
        and isinstance(percent, float)
        and isinstance(wanted, float)
        and percent <= ENLARGED * wanted
    )


def _words(finding: Finding) -> str:
    drive = finding.values.get("drive")
    return f"{drive}: {finding.message}" if drive else finding.message


def nearest(serves: Callable[[float, bool], bool], bad: float, good: float, part: float = SAME) -> tuple[float, float]:
    """The value next to ``bad`` that serves, on the way from it to one that does, and the one beyond that does not: by halves, to a part of
    the larger one.

    serves: value, whether a quick look will do -> whether it serves
    """
    finest = part * max(abs(good), abs(bad))
    for quick in (True, False):
        near = good
        while abs(near - bad) > finest:
            middle = 0.5 * (bad + near)
            near, bad = (middle, bad) if serves(middle, quick) else (near, middle)
        if serves(near, False):
            return near, bad
        bad = near
    return good, bad
