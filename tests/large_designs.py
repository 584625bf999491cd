"""Large and odd designs, and what they may cost at most, in counts that no busy machine changes: none may run away."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from linkages import chain

from core import project
from core.design import Design
from core.errors import DesignError
from core.study import Study, certificate_of, findings_of
from core.study.stages import clear_caches

EXAMPLES = Path(__file__).parents[1] / "resources" / "examples"
MIB = 2**20
Run = Callable[[], object]


@dataclass(frozen=True)
class Case:
    """A run made anew each time, and its most calls of functions and bytes held at once."""

    what: str
    fresh: Callable[[], Run]
    calls: int
    peak: int


def _around_the_segments(example: str) -> tuple[str, str]:
    text = (EXAMPLES / f"{example}.toml").read_text(encoding="utf-8")
    return text.split("[[motion.segments]]")[0], text[text.index("[follower]") :]


def _assuming_nothing(text: str) -> str:
    """Without the list of what is assumed, which names segments."""
    before, _, rest = text.partition("assumed = [")
    return before + rest.partition("]\n")[2]


def _segment(law: str, span: float, rise: float) -> str:
    return f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span!r}\n' + (f"rise_mm = {rise!r}\n" if rise else "")


def short_fall(span: float) -> str:
    """Kim1990's cam whose fall takes that little [deg], and then dwells."""
    head, tail = _around_the_segments("kim_1990")
    rows = (("simple-harmonic", 90.0, 9.0), ("simple-harmonic", span, -9.0), ("dwell", 270.0 - span, 0.0))
    return head + "".join(_segment(*row) for row in rows) + tail


def many_segments(count: int) -> str:
    """The card picker by so many short segments, up and down by turns."""
    head, tail = _around_the_segments("card_picker")
    head = _assuming_nothing(head)
    laws = ("cycloidal", "3-4-5", "modified-sine", "simple-harmonic")
    rows = ((laws[i % 4], 360.0 / count, 1e-3 * (-1) ** i) for i in range(count))
    return head + "".join(_segment(*row) for row in rows) + tail


def _checked(text: str) -> Callable[[], Run]:
    """What ``check`` does."""

    def fresh() -> Run:
        clear_caches()

        def run() -> object:
            study = Study(project.loads(text))
            return findings_of(study), certificate_of(study)

        return run

    return fresh


def _certificate(design: Design) -> Callable[[], Run]:
    """Of a linkage that is solved already."""

    def fresh() -> Run:
        clear_caches()
        study = Study(design)
        _ = study.linkage, study.dynamics
        return lambda: certificate_of(study)

    return fresh


def _refused(text: str) -> Callable[[], Run]:
    def run() -> object:
        try:
            return project.loads(text)
        except DesignError as error:
            return error

    return lambda: run


def cases(segments: int = 3000) -> tuple[Case, ...]:
    """segments   of the design that has many"""
    lift = (EXAMPLES / "transfer_lift.toml").read_text(encoding="utf-8")
    head, _ = _around_the_segments("transfer_lift")
    unknown = lift + "".join(f"key{i} = {i}\n" for i in range(60_000))
    return (
        Case("certificate of 60 links", _certificate(chain(60)), 200_000, 80 * MIB),
        Case("check of a fall in 0.09°", _checked(short_fall(0.09)), 600_000, 300 * MIB),
        Case("check of a fall in 0.01°", _checked(short_fall(0.01)), 600_000, 300 * MIB),
        Case(
            f"check of {segments:,} segments",
            _checked(many_segments(segments)),
            500_000 + 500 * segments,
            segments * MIB // 10,
        ),
        Case("refusal of 60,000 unknown keys", _refused(unknown), 100_000, 20 * MIB),
        Case(
            "refusal of 100,000 empty segments",
            _refused(head + "[[motion.segments]]\n" * 100_000),
            300_000,
            20 * MIB,
        ),
    )
