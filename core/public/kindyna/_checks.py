"""Arguments of the library: names that exist, numbers, angles; an error is one line that names the argument."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.project.reading_faults import did_you_mean
from core.units import UNITS

_MOST_NAMES = 12
Array = NDArray[np.float64]


def unknown(what: str, name: object, names: Iterable[str], reason: str = "") -> KeyError:
    """Return the error for a name that does not exist; it suggests the nearest name, or lists names, unless a reason is known."""
    known = tuple(names)
    near = did_you_mean(str(name), known)
    listed = ", ".join(known[:_MOST_NAMES]) + (", ..." if len(known) > _MOST_NAMES else "")
    return KeyError(f"{name!s}: no such {what}{near}{reason or ('' if near else f'; allowed: {listed}')}")


def text(what: str, value: object) -> str:
    """Return a text. Raises TypeError."""
    if not isinstance(value, str):
        raise TypeError(f"{what} = {value!r}: a text is needed, not {type(value).__name__}")
    return value


def texts(what: str, values: Any) -> list[str]:
    """Return a list of texts. Raises TypeError."""
    is_list = isinstance(values, Iterable) and not isinstance(values, str)
    if not is_list or not all(isinstance(value, str) for value in values):
        raise TypeError(f"{what} = {values!r}: a list of texts is needed, as ['pressure_angle_deg:max']")
    return list(values)


def mapping(what: str, value: Any) -> Mapping[str, Any]:
    """Return a mapping. Raises TypeError."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{what} = {value!r}: a mapping is needed, not {type(value).__name__}")
    return value


def path_of(what: str, value: object) -> str:
    """Return the path of a file or folder. Raises TypeError."""
    if not isinstance(value, str | os.PathLike):
        raise TypeError(f"{what} = {value!r}: a text or a path is needed, not {type(value).__name__}")
    return os.fspath(value) if isinstance(value, str) else str(value)


def path_to_write(what: str, value: object) -> Path:
    """Return the path of a file or folder to write. Raises TypeError, ValueError."""
    path = path_of(what, value)
    if not path.strip():
        raise ValueError(f"{what} = {value!r}: the path of a file or folder is needed")
    return Path(path)


def number(what: str, value: Any) -> float:
    """Return a finite number. Raises TypeError, ValueError."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise TypeError(f"{what} = {value!r}: a number is needed, not {type(value).__name__}")
    if not math.isfinite(value):
        raise ValueError(f"{what} = {value!r}: a finite number is needed")
    return float(value)


def whole(what: str, value: Any) -> int:
    """Return a whole number. Raises TypeError, ValueError."""
    result = number(what, value)
    if not result.is_integer():
        raise ValueError(f"{what} = {value!r}: a whole number is needed")
    return int(result)


def vector(what: str, values: ArrayLike) -> Array:
    """Return a vector (n,) of finite numbers, read-only. Raises TypeError, ValueError."""
    try:
        result = np.asarray(values)
    except ValueError:
        raise ValueError(f"{what}: a list of numbers is needed, not rows of different lengths") from None
    if result.dtype.kind not in "iuf":
        raise TypeError(f"{what}: numbers are needed, not {result.dtype}")
    if result.ndim != 1 or not result.size:
        raise ValueError(f"{what}: a list of numbers is needed, at least one; it has the shape {result.shape}")
    if not np.isfinite(result).all():
        raise ValueError(f"{what}: finite numbers are needed; number {int(np.argmin(np.isfinite(result)))} is not")
    return read_only(result)


def brief(line: str) -> str:
    """Return a line of at most 120 characters."""
    return line if len(line) <= 120 else line[:117] + "..."


def read_only(values: ArrayLike) -> Array:
    """Return a read-only copy as float64."""
    result = np.array(values, dtype=np.float64)
    result.flags.writeable = False
    return result


def words_column(words: ArrayLike) -> NDArray[np.str_]:
    """Return a read-only copy of words."""
    result = np.array(words, dtype=np.str_)
    result.flags.writeable = False
    return result


def points(complex_metres: NDArray[np.complex128]) -> Array:
    """Return points (n,) complex [m] as coordinates (n, 2) [mm], read-only."""
    return read_only(np.column_stack((complex_metres.real, complex_metres.imag)) / UNITS["mm"].factor)
