"""The benchmark itself: its rows and columns, that our errors keep to their bounds, what its table says, what makes its
check fail. Nothing here depends on how fast the machine is."""

import csv
import io
import json
import math
from dataclasses import replace
from itertools import count, pairwise
from pathlib import Path

import numpy as np
import pytest
from benchmarks import check, designs, measuring, picture, processes, ratios, targets, timing
from benchmarks.measuring import Plan, Row
from benchmarks.table import Kernel, Method, kernels
from PySide6.QtGui import QImage

from core.errors import KindynaError

KERNELS = {kernel.name: kernel for kernel in kernels()}
COMPILED = [
    pytest.param(k, m, id=f"{k.name}: {m.name}")
    for k in KERNELS.values()
    for m in k.methods
    if m.lacks or "numba" in m.name
]  # to compile one takes seconds


# -- the rows ---------------------------------------------------------------------------------------------


def test_every_kernel_has_our_method_first_and_others_beside_it() -> None:
    wanted = {"law", "blending", "linkage", "dyads", "profile", "curvature", "torque", "chain", "flywheel"}
    wanted |= {"tongues", "monodromy", "wind-up"}
    assert wanted == set(KERNELS)
    for kernel in KERNELS.values():
        assert [m.ours for m in kernel.methods] == [True] + [False] * (len(kernel.methods) - 1)
        assert len(kernel.methods) >= 2
        assert len({m.name for m in kernel.methods}) == len(kernel.methods)
        assert kernel.rival[0] in {m.name for m in kernel.methods[1:]}


def require_all_channels(kernel: Kernel, method: Method) -> None:
    """In its first setting a method gives every channel of the kernel at all angles."""
    result = method.cold(kernel.given(kernel.grid(kernel.usual)), method.settings[0])
    assert len(result) == len(kernel.exact.scale), (kernel.name, method.name)
    assert {np.shape(channel)[-1:] for channel in result} == {kernel.grid(kernel.usual).shape}, (
        kernel.name,
        method.name,
    )


def test_every_method_of_a_kernel_does_its_job_with_the_error_it_is_compared_by() -> None:
    """Ours within the error of a channel, or within its setting; the rival of our times as exact as a search; the others within a
    thousandth in their first setting, so that no row compares different results. Methods to be compiled run under stress alone."""
    wrong = []
    for name, kernel in KERNELS.items():
        promised = 1e-9 if name.startswith("wind-up") else 1e-12
        bounds = [(kernel.ours, setting, max(promised, setting or 0.0)) for setting in kernel.ours.settings]
        bounds.append((next(m for m in kernel.methods if m.name == kernel.rival[0]), kernel.rival[1], 1e-9))
        daily = [m for m in kernel.methods if not m.lacks and "numba" not in m.name]
        bounds += [(m, m.settings[0], 1e-3) for m in daily]
        wrong += [(name, m.name, setting) for m, setting, bound in bounds if kernel.error(m, setting) > bound]
        for method in daily:
            require_all_channels(kernel, method)
    assert wrong == []


@pytest.mark.stress
@pytest.mark.parametrize(("kernel", "method"), COMPILED)
def test_a_compiled_method_does_the_kernels_job(kernel: Kernel, method: Method) -> None:
    if method.lacks:
        pytest.skip(f"{method.lacks} is not installed")
    assert kernel.error(method, method.settings[0]) <= 1e-3
    require_all_channels(kernel, method)


def test_many_designs_by_hand_have_the_extremes_of_ours() -> None:
    for row in designs.ROWS:
        few = replace(row, count=4)
        for ours, by_hand in zip(few.ours(), few.by_hand(), strict=True):
            assert by_hand == pytest.approx(ours, rel=1e-6), row.name


# -- what comes out ---------------------------------------------------------------------------------------

TINY = Plan(usual=0.0, settings=1)


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    """A run as short as can be, of two kernels."""
    told: list[Row] = []
    for name in ("law", "curvature"):
        told += measuring.of_kernel(KERNELS[name], TINY)
    return told


def test_the_csv_has_the_columns_and_a_row_for_every_method(rows: list[Row]) -> None:
    told = list(csv.DictReader(io.StringIO(measuring.as_csv(rows))))
    assert list(told[0])[:6] == ["kernel", "method", "n", "seconds", "error", "setting"]
    for name in ("law", "curvature"):
        usual = [r for r in told if r["kernel"] == name and int(r["n"]) == 3600]
        methods = [m.name for m in KERNELS[name].methods if not m.lacks]
        usual = [r for r in usual if r["seconds"]]
        assert [r["method"] for r in usual if r["regime"] == "warm"] == methods
        assert [r["method"] for r in usual if r["regime"] == "cold"] == methods
        for row in usual:
            assert float(row["seconds"]) > 0.0
            assert 0.0 < float(row["error"]) < 1.0


def test_a_package_that_is_not_there_is_said_in_its_row() -> None:
    law = KERNELS["law"]
    absent = Method("absent", lambda given, setting: [given], needs=("json", "no_such_package"))
    kernel = replace(law, methods=(law.ours, absent))
    told = list(measuring.of_kernel(kernel, TINY))
    assert [r.method for r in told] == ["KINDYNA", "KINDYNA", "absent"]
    assert told[2].note == "no_such_package is not installed"
    row = list(csv.reader(io.StringIO(measuring.as_csv(told))))[-1]
    assert (row[3], row[4], row[7]) == ("", "", "no_such_package is not installed")


def row(
    method: str, warm: float, error: float, setting: str = "", cold: float | None = None, note: str = ""
) -> list[Row]:
    """A method warm and cold."""
    times = ((warm, "warm"), (warm if cold is None else cold, "cold"))
    return [Row("law", method, 3600, time, error, setting, time, note, regime, 0.01) for time, regime in times]


TOLD = [
    *row("KINDYNA", 1.0, 1e-15, cold=2.0),
    *row("numpy by hand", 0.4, 2e-15),
    *row("quintic table", 0.5, 1e-7, "0.001"),
    *row("quintic table", 3.0, 1e-9, "1e-05"),
    *row("nearest value of a table", math.nan, math.nan, note="sums is not installed"),
    *row("linear table by even steps", 0.1, 1e-4, "90", cold=0.2),
    *row("linear table by even steps", 6.8, 1e-6, "36000", cold=6800.0),
]


def cells(table: str, method: str) -> list[list[str]]:
    """The cells of a method's lines, warm and cold."""
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines() if line.startswith("|")]
    first = next(i for i, line in enumerate(lines) if line[0] == method)
    return [lines[first], *(line for line in lines[first + 1 : first + 2] if not line[0])]


def test_each_method_stands_at_every_error_with_its_quickest_setting_for_it_warm_and_cold() -> None:
    told = ratios.markdown(TOLD)
    warm, cold = cells(told, "quintic table")
    assert warm == ["quintic table", "warm", "1·10⁻⁹", *["0.5"] * 5, "3", "3", *["–"] * 3]
    assert cold == ["", "cold", "", *["0.2"] * 5, *["1.5"] * 2, *["–"] * 3]
    warm, cold = cells(told, "linear table by even steps")
    assert (warm[3:7], cold[3:7]) == (["0.10", "0.10", "7", "7"], ["0.10", "0.10", "3000", "3000"])
    assert cells(told, "KINDYNA")[0][3:] == ["1"] * 10
    assert "KINDYNA cold takes 2 times as long as warm." in told
    assert "| nearest value of a table | sums is not installed |" in told
    assert "ms" not in told.replace("sums", "")


def test_the_strongest_rival_stands_in_the_regime_that_is_worse_for_us_and_wins_in_the_words_in_which_it_loses() -> (
    None
):
    told = next(line for line in ratios.short(TOLD).splitlines() if line.startswith("| Law"))
    table, branches = "linear table by even steps, warm: 10 times faster", "numpy by hand*, cold: 5 times faster"
    without = [f"{branches}; quintic table, cold: {words}" for words in ("4 times faster", "1.5 times slower")]
    assert [cell.strip() for cell in told.split("|")[2:-1]] == ["1·10⁻¹⁵", table, *without, branches]
    slower = [replace(r, seconds=6.5 * r.seconds) for r in TOLD if r.method != "KINDYNA"]
    told = ratios.short([r for r in TOLD if r.method == "KINDYNA"] + slower)
    assert "linear table by even steps, warm: as fast" not in told
    assert "numpy by hand*, cold: 1.3 times slower" in told
    assert "no rival" in ratios.short([r for r in TOLD if r.method in ("KINDYNA", "linear table by even steps")])


def test_a_ratio_has_the_digits_that_the_next_run_shows_again() -> None:
    for value, noise, digits, words in (
        (2.4, 0.03, "2", "2 times slower"),
        (2.4, 0.01, "2.4", "2.4 times slower"),
        (0.7, 0.03, "0.7", "1.4 times faster"),
        (1.31, 0.03, "1.3", "1.3 times slower"),
        (0.4, 0.03, "0.4", "2 times faster"),
        (0.097, 0.05, "0.1", "10 times faster"),
        (340.0, 0.03, "300", "300 times slower"),
        (1.055, 0.03, "1.1", "as fast"),
        (0.95, 0.03, "0.9", "as fast"),
        (1.4, 0.05, "1", "as fast"),
        (0.7, 0.05, "0.7", "as fast"),
        (1.2, 0.2, "1", "as fast"),
    ):
        ratio = ratios.Ratio(value, noise)
        assert (ratio.digits, ratio.words) == (digits, words)


# -- cold and warm ----------------------------------------------------------------------------------------


def test_what_is_kept_is_made_once_warm_and_within_the_time_cold() -> None:
    made: list[float] = []
    seen: list[object] = []

    def keeps(there: object, points: float) -> str:
        made.append(points)
        return f"a table of {points}"

    def solve(there: object, kept: object) -> list[np.ndarray]:
        seen.append(kept)
        return [np.zeros(3)]

    method = Method("table", solve, (5,), keeps=keeps)
    kernel = replace(KERNELS["law"], methods=(KERNELS["law"].ours, method))
    warm = measuring.warm_run(kernel, method, None, 5)
    for _ in range(3):
        measuring.once(warm)
    assert (made, seen) == ([5], ["a table of 5"] * 3)
    cold = measuring.cold_run(kernel, method, None, 5)
    for _ in range(2):
        before = len(made)
        measuring.once(cold)
        assert len(made) == before + 1, "within the time"


def test_no_run_finds_the_results_of_an_earlier_one_in_the_linkage() -> None:
    """Each run gets a solved linkage that has not been read; everything derived from it is computed again."""
    for name in ("profile", "curvature", "torque"):
        kernel = KERNELS[name]
        given = kernel.given(kernel.grid(kernel.usual))
        first, second = kernel.again(given), kernel.again(given)
        assert first.kinematics is not second.kinematics
        assert first.motion is second.motion
        assert (first.kinematics.follower.origin[0] == second.kinematics.follower.origin[0]).all()


def test_a_request_to_be_blended_is_another_one_each_time() -> None:
    kernel = KERNELS["blending"]
    there = kernel.given(kernel.grid(1))
    assert len({kernel.again(there).request.settings["h1"] for _ in range(5)}) == 5


def test_cold_is_everything_forgotten() -> None:
    from core.blend.sequences import sequences

    kernel = KERNELS["blending"]
    there = kernel.given(kernel.grid(1))
    kernel.ours.cold(there, None)
    assert sequences.cache_info().currsize > 0
    measuring.cold_run(kernel, kernel.ours, there, None).make()
    assert sequences.cache_info().currsize == 0


def test_the_table_goes_between_its_markers_and_nowhere_else(tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text(f"before\n{ratios.BEGIN}\nold\n{ratios.END}\nafter\n", encoding="utf-8")
    for _ in range(2):
        ratios.into_page(path, "| new |\n")
        assert path.read_text(encoding="utf-8") == f"before\n{ratios.BEGIN}\n| new |\n{ratios.END}\nafter\n"
    path.write_text("nothing", encoding="utf-8")
    with pytest.raises((SystemExit, KindynaError)):
        ratios.into_page(path, "| new |\n")
    page = (measuring.HELP / "speed.md").read_text(encoding="utf-8")
    assert page.count(ratios.BEGIN) == page.count(ratios.END) == 1
    whole = page.partition(ratios.BEGIN)[2].partition(ratios.END)[0]
    for kernel in KERNELS.values():
        assert f"## {kernel.title}\n" in whole
        assert f"| {kernel.title} |" in whole
    for name in measuring.WINDOW:
        assert f"| {name}: " in whole
    assert measuring.PICTURE in (measuring.ROOT / "README.md").read_text(encoding="utf-8")


def test_the_picture_has_a_plot_for_each_kernel_that_was_measured(rows: list[Row]) -> None:
    one, two = (QImage.fromData(picture.picture(told)) for told in ([r for r in rows if r.kernel == "law"], rows))
    assert 0 < one.height() == two.height()
    assert picture.RATIO * 2 * picture.CELL[0] < two.width()


@pytest.mark.stress
def test_every_target_is_told_with_what_it_takes_and_what_is_missed_with_its_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(processes, "check", lambda times: processes.Checked(0.211, 0.09))
    frames = [
        (kernel, 3, 0.009)
        for kernel in ("animation, six-bar", "animation, six-bar at 1920 x 1080", "animation, several drives")
    ]
    six_bar = (("edit to paint, six-bar", 3, 0.02), ("drag to paint, six-bar", 12, 0.016), *frames)
    seen = (
        ("edit to paint", 6, 0.031),
        ("drag to paint", 12, 0.011),
        ("animation", 12, 0.009),
        *six_bar,
        ("start", 0, 0.750),
    )
    rows = [Row(kernel, "x", n, seconds, math.nan, "", 4.0) for kernel, n, seconds in seen]
    slower = replace(rows[0], seconds=0.04)
    told = targets.measured([*rows, replace(slower, n=12)], plan=replace(TINY, targets=0.02, large=False))
    assert all(t.taken >= 0.0 for t in told)
    lines = csv.DictReader(io.StringIO(targets.as_csv(told)))
    at = {line["what"]: (line["allowed"], line["taken"], line["unit"], line["met"]) for line in lines}
    assert len(at) == len(told) == 31
    assert at["edit until six plots and the mechanism are painted, findings later"] == ("20", "31", "ms", "no")
    assert at["frame of a six-bar with its table of centres and three plots"] == ("8", "9", "ms", "no")
    assert at["start until the mechanism of the lift is drawn, warm"] == ("300", "750", "ms", "no")
    missed = [replace(t, taken=2.0 * t.allowed) for t in told]
    shown = [line for line in targets.markdown(missed).splitlines() if "**missed**" in line]
    assert len(shown) == len(told)
    assert "7.8 ms of it are a bare repaint" in next(line for line in shown if "six plots" in line)
    words = "0.09 s are Python with numpy alone"
    assert (
        f"| `check` of the lift by Python with numpy alone | ≤ 1.7 times | 3.4 times | **missed**; {words} |" in shown
    )


def test_what_a_process_holds_at_most_is_its_own() -> None:
    held = np.ones(16 << 20)
    assert 5.0 < processes.used(("-c", "pass")).peak_mib < 100.0 < held.nbytes / 2**20
    with pytest.raises(RuntimeError, match="exit code 3"):
        processes.used(("-c", "raise SystemExit(3)"))


# -- time --------------------------------------------------------------------------------------


def test_the_best_of_each_run_is_told_and_all_run_in_turn() -> None:
    order: list[str] = []
    runs = {name: (lambda name=name: order.append(name)) for name in "ab"}
    times = timing.measure(runs, 0.01, rounds=3)
    assert set(times.seconds) == {"a", "b"}
    assert 0.0 < times.seconds["a"] < 1e-3
    changes = sum(x != y for x, y in pairwise(order))
    assert changes >= 3, "interleaved"


# -- the check --------------------------------------------------------------------------------------------


def test_a_limit_stands_for_every_row_and_one_that_is_not_kept_yet_says_why() -> None:
    limits = json.loads(check.FILE.read_text(encoding="utf-8"))
    assert set(limits) == set(check.keys())
    for limit in limits.values():
        assert limit["limit"] > 0.0
        assert ("today" in limit) == ("why" in limit)
        assert limit.get("today", math.inf) > limit["limit"]
    assert all(limits[f"many: {row.name}"]["limit"] == 2.0 for row in designs.ROWS)


@pytest.mark.parametrize(
    ("limit", "fails"),
    [({}, True), ({"limit": 0.9}, True), ({"limit": 1.0}, False), ({"limit": 0.1, "today": 0.9}, False)],
)
def test_who_is_beyond_the_limit_or_has_none_fails(limit: dict[str, float], fails: bool) -> None:
    assert bool(check.failing({"x": limit}, lambda name: 1.0, ["x"])) == fails


def test_who_is_too_slow_is_looked_at_again_before_it_fails() -> None:
    looks = count()
    assert check.failing({"x": {"limit": 1.2}}, lambda name: (3.0, 2.0, 1.1)[next(looks)], ["x"]) == {}
    assert next(looks) == 3
    asked: list[str] = []

    def always_slow(name: str) -> float:
        asked.append(name)
        return 9.0 if name == "slow" else 1.0

    limits = {"slow": {"limit": 1.0}, "quick": {"limit": 1.0}}
    assert check.failing(limits, always_slow, ["slow", "quick"], tries=4) == {"slow": 9.0}
    assert (asked.count("slow"), asked.count("quick")) == (4, 1)
