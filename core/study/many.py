"""Many designs at once: one design with some of its numbers varied, and figures of every variant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from core.design import Design
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.study.quantity_requests import number_fields, quantity_request
from core.study.stages import evaluations


@frozen(eq=False)
class Many:
    """Figures of m designs.

    Attributes
    ----------
    value : mapping of str -> ndarray (m,)
        Requested figure -> its values, in the unit of the quantity's column; NaN where a design has no solution.
    angle_deg : mapping of str -> ndarray (m,) [deg]
        Cam angles of extremes; NaN for other figures.
    reason : ndarray (m,)
        Code of the error or finding because of which a design has no value, or cannot be built; else empty.
    """

    value: Mapping[str, np.ndarray]
    angle_deg: Mapping[str, np.ndarray]
    reason: np.ndarray


def many(
    design: Design,
    values: Mapping[str, Any],
    quantities: Sequence[str],
    *,
    polish: bool = True,
    executor: Any = None,
) -> Many:
    """Figures of m designs that differ in the numbers at some paths.

    Parameters
    ----------
    design : Design
    values : mapping of str -> ndarray (m,)
        Path -> its numbers, in the unit of the field, as for ``design.put``.
    quantities : sequence of str
        Column and statistic of a quantity, as ``pressure_angle_deg:max`` (``STATISTICS``), or one of ``TOTALS``. Of several
        drives on a shaft ``drives[0].<column>:max``, and ``torque_nm:max`` of their total torque.
    polish : bool
        Refine the extremes; without it they are those of the nodes, to about 1e-3.
    executor : concurrent.futures.Executor or None
        Evaluates the blocks; the values do not depend on it.

    Returns
    -------
    Many

    Raises
    ------
    ValueError
        Where the design lacks a path or a quantity, or the numbers have no common shape (m,).
    """
    from core.study.batch import block_results, block_size  # imported with all it needs on the first call

    infos = number_fields(design, values)
    columns, requests = _columns(values), [quantity_request(design, key) for key in quantities]
    if not requests:
        raise ValueError("quantities: give at least one")
    rows = np.array(list(columns.values()))
    evaluations["many"] += rows.shape[1]
    size = block_size(design)
    parts = [rows[:, first : first + size] for first in range(0, rows.shape[1], size)]
    work = partial(block_results, design, infos, tuple(requests), polish)
    if executor is None:
        results = []
        for part in parts:
            checkpoint()
            results.append(work(part))
    else:
        results = [future.result() for future in [executor.submit(work, part) for part in parts]]
    value, theta = (np.concatenate(rows, axis=1) for rows in zip(*((r.value, r.theta) for r in results), strict=True))
    return Many(
        {request.key: value[i] / request.unit for i, request in enumerate(requests)},
        {request.key: np.rad2deg(theta[i]) for i, request in enumerate(requests)},
        np.concatenate([result.reason for result in results]),
    )


def _columns(values: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Path -> its numbers (m,). Raises ValueError, which names the path."""
    if not values:
        raise ValueError("values: no path is varied")
    columns: dict[str, np.ndarray] = {}
    for path, numbers in values.items():
        row = np.asarray(numbers)
        if row.dtype.kind not in "iuf":
            raise ValueError(f"{path}: numbers are needed, not {row.dtype}")
        if row.ndim != 1 or not row.size:
            raise ValueError(f"{path}: a list of numbers is needed, at least one; it has the shape {row.shape}")
        first_path, first = next(iter(columns.items()), (path, row))
        if row.size != first.size:
            raise ValueError(
                f"{path}: {row.size} values, but {first_path} has {first.size}: give the same number of values"
            )
        columns[path] = row.astype(float)
    return columns
