"""Varied fields, figures and limits as rows of a study file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.commands.studies import MOST_WORKERS
from core.design.design import Design
from core.errors import MISSING, DesignError, Fault
from core.project.reading_faults import did_you_mean, hinted
from core.varying.request import StudyOfMany, study_of_table
from core.varying.surveys import split_key
from kindyna._checks import number, read_only, vector, whole, words_column


def varied_study(
    design: Design, fields: Mapping[str, Mapping[str, Any]], **figures: Mapping[str, Mapping[str, Any]]
) -> StudyOfMany:
    """Return the study of a design.

    Parameters
    ----------
    design : Design
    fields : path -> further keys of its row
    **figures : list of a study file -> figure, as ``pressure_angle_deg:max`` or a total, or the path of a field -> further keys of its row

    Raises
    ------
    KindynaError
        With all faults; their paths begin with the path of the field, or with the figure.
    """
    table: dict[str, Any] = {"design": "", "vary": [{"field": path, **row} for path, row in fields.items()]}
    names = {f"vary[{i}]": path for i, path in enumerate(fields)}
    for name, rows in figures.items():
        table[name] = [{**({"field": key} if key in fields else _figure(key)), **row} for key, row in rows.items()]
        names |= {f"{name}[{i}]": key for i, key in enumerate(rows)}
    try:
        return study_of_table(table, design)
    except DesignError as error:
        raise DesignError([hinted(_named(fault, names)) for fault in error.faults]) from None


def _figure(key: str) -> dict[str, Any]:
    quantity, of = split_key(key)
    return {"quantity": quantity} if of is None else {"quantity": quantity, "of": of}


def _named(fault: Fault, names: Mapping[str, str]) -> Fault:
    """Return a fault whose path begins with the name of its row."""
    row, bracket, entry = fault.path.partition("]")
    name, entry = names.get(f"{row}{bracket}"), entry.lstrip(".")
    if name is None:
        return fault
    if entry in ("", "field", "quantity"):
        return replace(fault, path=name, value=MISSING)
    return replace(fault, path=f"{name}, {entry}")


def varied_values(path: str, given: Any) -> dict[str, Any]:
    """Return the row of a field with its values, words, or a range (low, high, steps). Raises TypeError, ValueError."""
    if isinstance(given, tuple):
        if len(given) != 3:
            raise ValueError(f"{path} = {given!r}: a range is (low, high, steps); a list has the values")
        low, high, steps = given
        return {"low": number(path, low), "high": number(path, high), "steps": whole(path, steps)}
    return {"choices": list(given)} if _are_words(given) else {"values": vector(path, given).tolist()}


def varied_range(path: str, given: Any) -> dict[str, Any]:
    """Return the row of a field with its bounds (low, high), or its choices of words. Raises TypeError, ValueError."""
    if _are_words(given):
        return {"choices": list(given)}
    ends = vector(path, given)
    if ends.size != 2:
        raise ValueError(f"{path} = {given!r}: two bounds are needed, (low, high), or a list of words")
    return {"low": float(ends[0]), "high": float(ends[1])}


def _are_words(given: Any) -> bool:
    return (
        isinstance(given, Sequence)
        and not isinstance(given, str)
        and bool(given)
        and all(isinstance(word, str) for word in given)
    )


def limit_ends(key: str, ends: Any) -> dict[str, float]:
    """Return least and greatest value of a limit. Raises TypeError, KeyError, ValueError."""
    if not isinstance(ends, Mapping):
        raise TypeError(f"limit {key} = {ends!r}: a mapping with min, max or both is needed, not {type(ends).__name__}")
    for name in ends:
        if name not in ("min", "max"):
            raise KeyError(
                f"limit {key}: {name}: no such end{did_you_mean(str(name), ('min', 'max'))}; allowed: min, max"
            )
    return {name: number(f"limit {key}, {name}", value) for name, value in ends.items()}


def process_count(workers: Any) -> int:
    """Return a number of processes. Raises TypeError, ValueError."""
    count = whole("workers", workers)
    if not 1 <= count <= MOST_WORKERS:
        raise ValueError(f"workers = {count}: processes; allowed: 1 ... {MOST_WORKERS}")
    return count


def fixed_column(column: NDArray[Any]) -> NDArray[Any]:
    """Return numbers as float64, or words, read-only."""
    return words_column(column) if column.dtype == np.object_ else read_only(column)
