"""Design files that are damaged: entries replaced or taken away by their paths, and what is said about that."""

import copy
import math
import re
from typing import Any

import pytest
import tomli_w
from hypothesis import strategies as st

from core import project
from core.design import Design, faults
from core.errors import DesignError

GONE = object()
"""In place of a value: the entry is taken away."""
BAD = [GONE, math.nan, math.inf, -1.0, 0, 10**400, True, "", "x", [], {}, [1], {"a": 1}]


def changed(table: dict[str, Any], edits: dict[str, Any]) -> dict[str, Any]:
    """A design's tables with the entries at some paths replaced, or taken away (GONE), or added at the end of a list."""
    table = copy.deepcopy(table)
    for path, value in edits.items():
        *way, last = (int(n) if n else key for key, n in re.findall(r"([^.\[\]]+)|\[(\d+)\]", path))
        at: Any = table
        for step in way:
            at = at[step]
        if value is GONE:
            del at[last]
        elif isinstance(at, list) and last == len(at):
            at.append(value)
        else:
            at[last] = value
    return table


def told(source: dict[str, Any] | str) -> dict[str, str]:
    """The faults of tables or of a text: path -> line."""
    with pytest.raises(DesignError) as caught:
        project.loads(source if isinstance(source, str) else tomli_w.dumps(source))
    lines = {fault.path: str(fault) for fault in caught.value.faults}
    assert len(lines) == len(caught.value.faults), "one fault for each path"
    assert str(caught.value).splitlines() == list(lines.values()), "one line for each fault"
    return lines


def damage(table: dict[str, Any], data: st.DataObject) -> None:
    """Somewhere in the tables something is taken away, or becomes what it should not be."""
    at: Any = table
    while True:
        keys = list(at) if isinstance(at, dict) else list(range(len(at)))
        if not keys:
            return
        key = data.draw(st.sampled_from(keys))
        if isinstance(at[key], dict | list) and data.draw(st.booleans()):
            at = at[key]
            continue
        value = data.draw(st.sampled_from([*BAD, at[key]]))
        if value is GONE:
            del at[key]
        else:
            at[key] = copy.deepcopy(value)
        return


def told_or_sound(table: dict[str, Any]) -> None:
    """Asserts: these tables are a design without faults that comes back from its file, or there is a line for each."""
    design, error = _outcome(table)
    if design is None:
        assert error.faults
        assert len(str(error).splitlines()) == len(error.faults)
    else:
        assert faults(design) == []
        assert project.loads(project.dumps(design)) == design


def _outcome(table: dict[str, Any]) -> tuple[Design | None, DesignError]:
    try:
        return project.from_table(table), DesignError([])
    except DesignError as error:
        return None, error
