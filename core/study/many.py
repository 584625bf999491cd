"""Many designs at once: one design with some of its numbers varied, and what is asked of a quantity over the turn of each."""

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
    """Of m designs: what was asked -> value (m,), and cam angle [deg] (m,) of an extreme, else NaN; in the unit of the quantity's column.

    reason  (m,) why a design has no value, or none to build by: code of the error or finding; else empty
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
    """What is asked of each of m designs, which differ in the numbers at some paths.

    values      path -> (m,), in the unit of the field, as ``design.put`` takes it
    quantities  ``"<column>:max"``, or min, abs, rms, mean, range (``OVER_TURN``) of a quantity by its column, as
                ``pressure_angle_deg:max``; or one of ``TOTALS``. Of several drives on a shaft ``drives[0].<column>:max``, and
                ``torque_nm:max`` of what all ask of it together
    polish      extremes are refined; without it they are those of the nodes, to about 1e-3
    executor    any of the shape of ``concurrent.futures.Executor``; values do not depend on it

    A design that has no answer is NaN, with its reason. Raises ValueError for what cannot be asked.
    """
    from core.study.batch import (
        block,
        block_size,  # with all that it needs, when it is asked
    )

    infos = number_fields(design, values)
    given, asked = _given(values), [quantity_request(design, each) for each in quantities]
    if not asked:
        raise ValueError("quantities: none is asked for")
    rows = np.array(list(given.values()))
    evaluations["many"] += rows.shape[1]
    size = block_size(design)
    parts = [rows[:, first : first + size] for first in range(0, rows.shape[1], size)]
    work = partial(block, design, infos, tuple(asked), polish)
    if executor is None:
        found = []
        for part in parts:
            checkpoint()
            found.append(work(part))
    else:
        found = [future.result() for future in [executor.submit(work, part) for part in parts]]
    value, theta = (np.concatenate(rows, axis=1) for rows in zip(*((f.value, f.theta) for f in found), strict=True))
    return Many(
        {each.key: value[i] / each.unit for i, each in enumerate(asked)},
        {each.key: np.rad2deg(theta[i]) for i, each in enumerate(asked)},
        np.concatenate([f.reason for f in found]),
    )


def _given(values: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """The columns as numbers (m,). Raises ValueError, naming the path."""
    if not values:
        raise ValueError("values: no path is varied")
    found: dict[str, np.ndarray] = {}
    for path, each in values.items():
        rows = np.asarray(each)
        if rows.dtype.kind not in "iuf":
            raise ValueError(f"{path}: numbers are needed, not {rows.dtype}")
        if rows.ndim != 1 or not rows.size:
            raise ValueError(f"{path}: a list of numbers is needed, at least one; it has the shape {rows.shape}")
        first, other = next(iter(found.items()), (path, rows))
        if rows.size != other.size:
            raise ValueError(f"{path}: {rows.size} values, but {first} has {other.size}: as many are needed")
        found[path] = rows.astype(float)
    return found
