"""DXF: files in millimetres, written by ezdxf."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

VERSION = "R2010"
COMMENT = 999  # group code
MILLIMETRES, METRIC = 4, 1  # values of $INSUNITS, $MEASUREMENT


@contextmanager
def without_clock() -> Iterator[None]:
    """Context in which ezdxf writes neither the time nor random numbers."""
    import ezdxf

    saved = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = saved


def dxf_file(comment: Sequence[str], draw: Callable[[Any], None]) -> bytes:
    """Content of a DXF file in millimetres, with comments; ``draw`` adds the shapes to ezdxf's drawing."""
    import ezdxf

    with without_clock():
        drawing = ezdxf.new(VERSION)
        drawing.header["$INSUNITS"], drawing.header["$MEASUREMENT"] = MILLIMETRES, METRIC
        draw(drawing)
        stream = io.StringIO()
        drawing.write(stream)
    remarks = "".join(f"{COMMENT}\n{line}\n" for line in comment)
    return (remarks + stream.getvalue()).encode("utf-8", "replace")
