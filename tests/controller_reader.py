"""What a controller makes of a file, in plain numpy and by other formulas: each file read by its own few lines, as the page of formats
says, and evaluated by Lagrange, Bernstein or Hermite bases."""

from __future__ import annotations

import re
from math import comb
from typing import Any

import numpy as np
from scipy.linalg import solve_banded

from core.process import resources
from core.project import load
from core.study import Study

QUINTIC, CUBIC, LINES = "quintic-hermite", "cubic-hermite", "linear"
LAWS = (
    "parabolic",
    "simple-harmonic",
    "cycloidal",
    "modified-sine",
    "modified-trapezoid",
    "3-4-5",
    "4-5-6-7",
    "constant-velocity",
)
_N = r"(-?\d+(?:[.,]\d+)?)"


def _floats(text: str) -> list[float]:
    return [float(n.replace(",", ".")) for n in re.findall(_N, text)]


def rows_of(slug: str, text: str, turn: float, advance: float = 0.0) -> dict[str, Any]:
    """Angles as parts of the turn (n,), values, and what else a row has; both ends of the turn are there. advance: of the slave in a
    turn of the master, by which the closing row is above the first where the file has none."""
    if slug in ("codesys-xyva", "codesys-cambuilder"):
        bounds = (
            rf"dX := {_N}, dY := {_N}, dV := {_N}, dA := {_N}"
            if slug == "codesys-xyva"
            else rf"SMCB.Bound\({', '.join([_N] * 4)}\)"
        )
        found = re.findall(bounds, text)
        x, y, v, a = np.array(found, float).T
        return {"x": x / turn, "y": y, "v": v * turn, "a": a * turn**2}
    if slug == "twincat-points":
        found = re.findall(rf"MasterPos := {_N}, SlavePos := {_N}, SlaveVelo := {_N}, SlaveAcc := {_N}", text)
        x, y, v, a = np.array(found, float).T
        return {"x": x / turn, "y": y, "v": v * turn, "a": a * turn**2}
    if slug == "codesys-xy":
        x, y = np.array(re.findall(rf"\[{_N}, {_N}\]", text), float).T
        return {"x": x / turn, "y": y}
    if slug == "codesys-x":
        y = np.array(_floats(text.split("Table := [")[1].split("]")[0]))
        scale = {
            key: [float(n) for n in re.findall(rf"f{key}(?:Min|Max) := {_N}", text)]
            for key in ("EditorSlave", "TableSlave")
        }
        factor = np.diff(scale["EditorSlave"])[0] / np.diff(scale["TableSlave"])[0]
        y = y * factor + scale["EditorSlave"][0] - scale["TableSlave"][0] * factor
        assert re.findall(r"nElements := (\d+)", text) == [str(y.size)]
        return {"x": np.arange(y.size) / (y.size - 1), "y": y}
    if slug == "twincat-table":
        rows, last = (
            int(re.findall(pattern, text)[0]) for pattern in (r"NoOfRows := (\d+)", r"ARRAY\[0\.\.(\d+), 0\.\.1\]")
        )
        x, y = np.array(_floats(text.split(":= [")[1].split("]")[0])).reshape(rows, 2).T
        assert rows == last + 1
        return {"x": x / turn, "y": y}
    if slug == "beckhoff-ascii":
        y = np.array(_floats(text.split("Begintable")[1]))
        return {"x": np.arange(y.size + 1) / y.size, "y": np.append(y[-1] - advance, y)}
    if slug == "beckhoff-zebra":
        counts = np.array(
            [
                [int(n) for n in line.split()]
                for line in text.split("Begintable\n")[1].split("\nEndTable")[0].split("\n")
            ]
        )
        x, y = counts.T * 1e-4
        assert x.size % 2 == 0
        assert x.size <= 360
        assert np.diff(counts[:, 0]).min() >= 1000
        return {"x": np.append(x / turn, 1.0), "y": np.append(y, y[0] + advance)}
    if slug in ("sew-tab", "sew-semicolon", "lenze-loader", "technosoft"):
        lines = [line for line in text.split("\n") if line.strip()][slug.startswith("sew") :]
        x, y = np.array([_floats(line) for line in lines]).T
        return {"x": x / turn, "y": y}
    if slug == "schneider-asc":
        head = dict(line.split("=") for line in text.split("\r\n")[:9])
        z = np.array([float(line) for line in text.split("\r\n")[10:] if line])
        y = float(head["YOffset"]) + float(head["YFactor"]) * z
        slopes = [float(head[k]) * float(head["YFactor"]) for k in ("StartSlope", "EndSlope")]
        return {"x": np.arange(z.size) / (z.size - 1), "y": y, "ends": slopes}
    if slug == "general":
        x, y, v, a = np.array([_floats(line) for line in text.split("\n")[1:] if line]).T
        steps = np.diff(x) / turn  # of the angles as written: parts of a turn lose digits of steps of 0.001 deg
        return {"x": x / turn, "h": steps, "y": y, "v": v * turn, "a": a * turn**2, "ends": v[[0, -1]] * turn}
    raise AssertionError(slug)


def path(kind: str, rows: dict[str, Any], count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Parts of the turn (n - 1, count), as good as both ends of every piece among them, and there value and two derivatives by it
    (3, n - 1, count)."""
    x, y = rows["x"], rows["y"]
    h = rows.get("h", np.diff(x))[:, None]
    u = np.linspace(1e-7, 1.0 - 1e-7, count)
    if kind == "linear":
        ends = [y[:-1], y[1:]]
    elif kind == "cubic-hermite":
        ends = _cubic(y, rows["v"], h[:, 0])
    elif kind == "quintic-hermite":
        ends = _quintic(y, rows["v"], rows["a"], h[:, 0])
    elif kind == "clamped-spline":
        ends = _cubic(y, _spline_slopes(h[:, 0], y, rows["ends"]), h[:, 0])
    else:  # zebra: quintic, straight, ...
        v = np.diff(y) / np.diff(x)
        slopes = np.empty(x.size)
        slopes[1:-1:2], slopes[2:-1:2] = v[1::2], v[1:-1:2]
        slopes[0] = slopes[-1] = v[-1]
        quintic = np.array(_quintic(y, slopes, 0.0 * y, h[:, 0]))
        straight = np.array([y[:-1] + k / 5.0 * np.diff(y) for k in range(6)])
        ends = list(np.where(np.arange(x.size - 1) % 2 == 1, straight, quintic))
    b = np.array(ends).T
    return x[:-1, None] + h * u, np.array([_bernstein(b, u, k) / h**k for k in range(3)])


def _cubic(y: np.ndarray, v: np.ndarray, h: np.ndarray) -> list[np.ndarray]:
    return [y[:-1], y[:-1] + h * v[:-1] / 3.0, y[1:] - h * v[1:] / 3.0, y[1:]]


def _quintic(y: np.ndarray, v: np.ndarray, a: np.ndarray, h: np.ndarray) -> list[np.ndarray]:
    left = [y[:-1], y[:-1] + h * v[:-1] / 5.0, y[:-1] + 2.0 * h * v[:-1] / 5.0 + h * h * a[:-1] / 20.0]
    right = [y[1:] - 2.0 * h * v[1:] / 5.0 + h * h * a[1:] / 20.0, y[1:] - h * v[1:] / 5.0, y[1:]]
    return left + right


def _spline_slopes(h: np.ndarray, y: np.ndarray, ends: list[float]) -> np.ndarray:
    """From the continuity of the second derivative at every inner row, as one banded system."""
    slopes = np.diff(y) / h
    bands, right = np.zeros((3, y.size)), np.empty(y.size)
    bands[1, [0, -1]], right[[0, -1]] = 1.0, ends
    bands[0, 2:], bands[2, :-2] = 1.0 / h[1:], 1.0 / h[:-1]
    bands[1, 1:-1] = 2.0 / h[:-1] + 2.0 / h[1:]
    right[1:-1] = 3.0 * (slopes[:-1] / h[:-1] + slopes[1:] / h[1:])
    return np.asarray(solve_banded((1, 1), bands, right))


def _bernstein(b: np.ndarray, u: np.ndarray, order: int) -> np.ndarray:
    n = b.shape[1] - 1
    for k in range(order):
        b = (n - k) * np.diff(b, axis=1)
    m = b.shape[1] - 1
    if m < 0:
        return np.zeros((b.shape[0], u.size))
    return np.asarray(sum(b[:, j : j + 1] * comb(m, j) * u**j * (1.0 - u) ** (m - j) for j in range(m + 1)))


# -- against the motion ------------------------------------------------------------------------------------


def example(name):
    """The file of an example."""
    return resources() / "examples" / f"{name}.toml"


def exact_motion(name, shift=0.0, reverse=False):
    """Parts of the turn -> value and two derivatives by it, from the motion's stage, which knows one turn: an advance goes on."""
    path_ = name if str(name).endswith(".toml") else example(name)
    study = Study(load(path_))
    scale, advance = study.design.drive.motion.scale, study.design.drive.motion.advance or 0.0

    def values(u):
        own = (u - shift / 360.0) * (-1.0 if reverse else 1.0)
        turns = np.floor(own)
        y = study.at_theta(2.0 * np.pi * (own - turns).ravel()).motion.y.reshape(4, *u.shape)
        sign = np.array([1.0, -1.0 if reverse else 1.0, 1.0])
        made = y[:3] / scale * sign[:, None, None] * (2.0 * np.pi) ** np.arange(3)[:, None, None]
        made[0] += advance * turns
        return made

    return values


def brute(slug, kind, text, exact, turn=360.0, scale=1.0, offset=0.0, count=200, advance=0.0):
    """Largest errors of value, velocity per degree and acceleration per degree², at 200 points of every piece."""
    rows = rows_of(slug, text, turn, advance)
    rows = {
        key: np.asarray(value) / (1.0 if key in ("x", "h") else scale) - (offset / scale if key == "y" else 0.0)
        for key, value in rows.items()
    }
    u, made = path(kind, rows, count)
    errors = np.abs(made - exact(u)).reshape(3, -1).max(axis=1)
    return errors / 360.0 ** np.arange(3)
