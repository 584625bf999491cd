"""What a drawing lacks to be a mechanism, by the rank of its velocity equations; and what check says of its file."""

from dataclasses import replace
from pathlib import Path

import pytest
from linkages import four_bar, link, slider_crank

from core.__main__ import main
from core.design import NO_DRIVER, Drawn, Linkage, LinkPoint, Slider, with_drive
from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.unfinished import driven_part, mobility
from core.project import load, loads
from core.project.writing import dumps
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
BAR = four_bar(60.0, 20.0, 50.0, 40.0)
LINKAGE = BAR.drive.linkage


def drawn(linkage: Linkage, driver_deg: float, **points: tuple[float, float]) -> Linkage:
    places = tuple(LinkPoint(name, float(x), float(y)) for name, (x, y) in points.items())
    return replace(linkage, branch=(), drawn=Drawn(driver_deg, None, places))


def three_cranks(third: float) -> Linkage:
    links = (
        link(1, O2=(0, 0), O4=(60, 0), O6=(30, 0)),
        link(2, O2=(0, 0), A=(20, 0)),
        link(3, A=(0, 0), B=(60, 0), C=(30, 0)),
        link(4, O4=(0, 0), B=(20, 0)),
        link(5, O6=(0, 0), C=(third, 0)),
    )
    return drawn(replace(LINKAGE, links=links), 40.0, A=(15.3, 12.9), B=(75.3, 12.9))


@pytest.mark.parametrize(
    "name", sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))
)
def test_a_mechanism_lacks_nothing(name: str) -> None:
    lack = mobility(load(EXAMPLES / f"{name}.toml").drive.linkage)
    assert lack.is_finished
    assert lack.sentences == ()


def test_what_hangs_loose_is_named_by_its_free_end_and_the_rest_moves() -> None:
    opened = drawn(replace(LINKAGE, links=LINKAGE.links[:3]), 45.0, A=(14, 14), B=(40, 35))
    lack = mobility(opened)
    assert lack.sentences == ("1 degree of freedom without a driver: B hangs loose: join it or ground it",)
    assert (lack.driven, lack.loose) == ((2,), (3,))
    part = driven_part(opened, lack)
    assert part is not None
    moved = Study(with_drive(BAR, mechanism=part), 8).linkage
    assert set(moved.bodies) >= {"link2"}
    assert abs(moved.bodies["link2"].point("A")[0]).max() == pytest.approx(0.02)


def test_without_a_driver_those_are_named_that_could_be() -> None:
    assert mobility(replace(LINKAGE, driver=NO_DRIVER)).sentences == (
        "1 degree of freedom without a driver: let links 2 or 4 drive",
    )
    assert mobility(Linkage((link(1),), drawn=Drawn())).freedom == 0


@pytest.mark.parametrize("at", [0.0, 180.0])
def test_a_dead_centre_is_no_loose_part(at: float) -> None:
    """Crank and rod in line, and the slider driven: there its velocity equations leave one more degree of freedom."""
    crank = slider_crank(20.0, 60.0).drive.linkage
    sign = 1.0 if at == 0.0 else -1.0
    along = replace(
        crank,
        driver=replace(crank.driver, link=4, kind="motion"),
        branch=(),
        drawn=Drawn(
            None, 60.0 + sign * 20.0, (LinkPoint("A", sign * 20.0, 0.0), LinkPoint("B", 60.0 + sign * 20.0, 0.0))
        ),
    )
    assert mobility(along).is_finished


def test_a_doubled_part_is_named_and_one_that_agrees_is_not() -> None:
    assert mobility(three_cranks(22.0)).sentences == ("1 too many: links 2, 3, 4 and 5 overconstrain each other",)
    agreeing = mobility(three_cranks(20.0))
    assert agreeing.is_finished
    assert agreeing.redundant == (2, 3, 4, 5)


def test_a_slide_on_a_loose_link_is_solved_as_far_as_it_is_led() -> None:
    """Two links more, one pinned to the coupler, one sliding on it: two degrees of freedom, and the four-bar runs."""
    links = (*LINKAGE.links, link(5, B=(0, 0), E=(30, 0)), link(6, F=(0, 0)))
    more = replace(LINKAGE, links=links, sliders=(*LINKAGE.sliders, Slider(link=6, on=5)))
    lack = mobility(more)
    assert lack.freedom == 2
    assert lack.driven == (2, 3, 4)
    part = driven_part(more, lack)
    assert part is not None
    whole = driver_ranges_of(part)
    assert whole.ranges[0].is_free


def test_check_says_the_same_and_answers_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    opened = drawn(replace(LINKAGE, links=LINKAGE.links[:3], driver=NO_DRIVER), 0.0, A=(14, 14), B=(40, 35))
    opened = replace(opened, drawn=replace(opened.drawn, driver_deg=None))
    text = dumps(with_drive(BAR, mechanism=opened))
    assert "driver =" not in text
    (tmp_path / "open.toml").write_text(text, "utf-8")
    assert main(["check", str(tmp_path / "open.toml")]) == 2
    said = capsys.readouterr()
    line = "linkage: 2 degrees of freedom without a driver: B hangs loose: join it or ground it; let link 2 drive"
    assert line in (said.out + said.err).splitlines()


def test_without_a_point_on_the_frame_a_point_is_to_be_grounded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two loose bars; what slides on the frame needs none."""
    bars = (link(1), link(2, A=(0, 0), B=(40, 0)), link(3, C=(0, 0), D=(50, 0)))
    loose = drawn(replace(LINKAGE, links=bars, driver=NO_DRIVER), 0.0, A=(0, 0), B=(40, 0), C=(0, 20), D=(50, 20))
    loose = replace(loose, drawn=replace(loose.drawn, driver_deg=None))
    file = tmp_path / "loose.toml"
    file.write_text(dumps(with_drive(BAR, mechanism=loose)), "utf-8")
    assert "points = {}" in file.read_text("utf-8")
    assert loads(file.read_text("utf-8"), unfinished=True).drive.mechanism == loose
    assert main(["check", str(file)]) == 2
    assert "linkage: 6 degrees of freedom without a driver: ground a point\n" in capsys.readouterr().err
    slides = replace(loose, sliders=(Slider(link=2, on=1),))
    assert "A" in mobility(slides).sentences[0]
