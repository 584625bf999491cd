"""Points of a path from strokes, tables and drawings: open and closed curves, columns by their names, refusals."""

import math
from pathlib import Path

import numpy as np
import pytest
from drawn_cams import drawn

from core.__main__ import main
from core.errors import KindynaError
from core.process import resources
from core.synthesis import TracedPath, load_task, task_of
from core.synthesis.path import with_points
from core.synthesis.path_points import read_path, stroke_path


def points(path: TracedPath | None) -> np.ndarray:
    assert path is not None
    return np.array([point.z for point in path.points])


def read(folder: Path, name: str, content: str | bytes, **options: object) -> TracedPath:
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_path(folder / name, **options)  # type: ignore[arg-type]


def test_an_open_curve_of_a_drawing_runs_from_end_to_end(tmp_path: Path) -> None:
    """A line of 30 mm, the half of a circle of 10 mm drawn backwards, a line of 20 mm: 81.4 mm in all."""
    shapes = (
        ("line", (0.0, 0.0), (30.0, 0.0)),
        ("arc", (30.0, 10.0), 10.0, -90.0, 90.0),
        ("lwpolyline", [(10.0, 20.0), (30.0, 20.0)]),
    )
    path = read(tmp_path, "open.dxf", drawn(*shapes))
    z = points(path)
    assert not path.closed
    assert {complex(z[0]), complex(z[-1])} == {0j, 10.0 + 20.0j}
    steps = np.abs(np.diff(z))
    length = 50.0 + 10.0 * math.pi
    assert steps.max() < 1.0001 * length / (z.size - 1)
    assert steps.sum() == pytest.approx(length, rel=1e-3)
    on_arc = z[z.real > 30.0]
    assert np.abs(np.abs(on_arc - (30.0 + 10.0j)) - 10.0).max() < 1e-12


def test_a_closed_curve_of_a_drawing_is_a_closed_path(tmp_path: Path) -> None:
    path = read(tmp_path, "ring.dxf", drawn(("circle", (30.0, 20.0), 25.0)))
    assert path.closed
    assert np.abs(np.abs(points(path) - (30.0 + 20.0j)) - 25.0).max() < 1e-12
    assert np.abs(np.diff(points(path), append=points(path)[0])).max() == pytest.approx(50.0 * math.sin(math.pi / 96.0))


def test_a_curve_that_crosses_itself_is_a_path(tmp_path: Path) -> None:
    q = np.linspace(0.0, 2.0 * np.pi, 61)[:-1] + 0.01
    eight = [(float(x), float(y)) for x, y in zip(50.0 * np.cos(q), 20.0 * np.sin(2.0 * q), strict=True)]
    path = read(tmp_path, "eight.dxf", drawn(("lwpolyline", eight, {"close": True})))
    assert path.closed
    assert np.abs(points(path).real).max() == pytest.approx(50.0, rel=1e-2)


def test_an_open_curve_can_be_closed(tmp_path: Path) -> None:
    shape = ("lwpolyline", [(0.0, 0.0), (30.0, 0.0), (30.0, 20.0)])
    assert read(tmp_path, "open.dxf", drawn(shape), closed=True).closed


@pytest.mark.parametrize(
    ("shapes", "message"),
    [
        ((("line", (0, 0), (10, 0)), ("line", (0, 5), (10, 5))), "2 curves on layer 0, which do not join; leave one"),
        ((("circle", (0, 0), 0.0),), "no curve: its lines, arcs, circles and polylines have no length"),
        (
            (("line", (0, 0), (9, 0)), ("line", (9, 0), (9, 9)), ("line", (9, 0), (20, 0))),
            "3 ends of lines and arcs meet",
        ),
    ],
)
def test_drawings_without_one_curve_are_refused(
    tmp_path: Path, shapes: tuple[tuple[object, ...], ...], message: str
) -> None:
    with pytest.raises(KindynaError, match=message):
        read(tmp_path, "bad.dxf", drawn(*shapes))


TABLE = "driver_angle_deg,A_x_mm,A_y_mm,P_x_mm,P_y_mm\n0,1,2,5,6\n90,3,4,7,8\n180,3,5,9,8\n"


def test_a_table_has_its_points_in_columns_with_their_names(tmp_path: Path) -> None:
    assert points(read(tmp_path, "linkage.csv", TABLE, point="P")).tolist() == [5 + 6j, 7 + 8j, 9 + 8j]
    assert points(read(tmp_path, "profile.csv", "cam_angle_deg,x_mm,y_mm\n0,1,2\n5,3,4\n")).tolist() == [1 + 2j, 3 + 4j]
    assert points(read(tmp_path, "plain.csv", "first;second\n1.5;2\nnote\n3;4\n")).tolist() == [1.5 + 2j, 3 + 4j]
    assert points(read(tmp_path, "comma.csv", "x_mm;y_mm\n1,5;2,25\n3,0;-4,5\n")).tolist() == [1.5 + 2.25j, 3 - 4.5j]
    with pytest.raises(KindynaError, match=r"linkage.csv: has the points A, P; state one of them as path.point"):
        read(tmp_path, "linkage.csv", TABLE)
    with pytest.raises(KindynaError, match=r"has no columns Q_x_mm and Q_y_mm; points in this table: A, P"):
        read(tmp_path, "linkage.csv", TABLE, point="Q")
    with pytest.raises(KindynaError, match=r"has no points; columns with x and y in mm are needed"):
        read(tmp_path, "empty.csv", "")
    with pytest.raises(KindynaError, match=r"curve.txt: no points of a path; allowed: .csv \| .dxf"):
        read(tmp_path, "curve.txt", TABLE)


def test_the_path_of_an_exported_point_is_a_task(tmp_path: Path) -> None:
    example = resources() / "examples" / "four_bar.toml"
    assert main(["export", str(example), "--out", str(tmp_path), "--samples", "36", "--only", "linkage"]) == 0
    (tmp_path / "task.toml").write_text(
        'kind = "path"\n[path]\nfile = "linkage.csv"\npoint = "C"\nclosed = true\n', "utf-8"
    )
    path = with_points(load_task(tmp_path / "task.toml")).path
    assert path is not None
    assert (path.closed, path.file, path.point) == (True, "", "")
    header, *rows = (tmp_path / "linkage.csv").read_text("utf-8").splitlines()
    x, y = (header.split(",").index(f"C_{axis}_mm") for axis in "xy")
    assert points(path).tolist() == [complex(float(row.split(",")[x]), float(row.split(",")[y])) for row in rows]
    with pytest.raises(KindynaError, match=r"path.point = 'C': is not used with points"):
        task_of({"kind": "path", "path": {"points": [[0, 0], [1, 2], [3, 1]], "point": "C"}})


def test_a_stroke_is_spaced_evenly_and_closed_where_it_returns() -> None:
    q = np.linspace(0.0, 6.2, 300) ** 1.3
    ring = 40.0 * np.exp(1j * q * 6.2 / q[-1])
    path = stroke_path(ring)
    assert path is not None
    assert path.closed
    steps = np.abs(np.diff(points(path), append=points(path)[0]))
    assert np.ptp(steps) < 0.01 * steps.mean()
    half = stroke_path(ring[: ring.size // 2])
    assert half is not None
    assert not half.closed
    assert abs(points(half)[-1] - ring[ring.size // 2 - 1]) < 1e-3
    assert stroke_path(np.zeros(5, dtype=complex)) is None
