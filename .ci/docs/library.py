"""Pages of the library: each public name with its docstring, each member with an anchor."""

import inspect
import re
from inspect import getdoc
from pathlib import Path
from textwrap import indent
from typing import Any

from cells import members
from markup import code, contents, table, text, words, write_page
from numpydoc.docscrape_sphinx import SphinxDocString

import kindyna as kd


def library(folder: Path) -> None:
    """The public names, each class on a page of its own and the functions on one, and an index; the texts are the docstrings."""
    items = {name: getattr(kd, name) for name in kd.__all__}
    kinds = [name for name, item in items.items() if isinstance(item, type)]
    functions = [name for name in items if name not in kinds]
    for name in kinds:
        write_page(folder / f"{name}.rst", f"{heading(name)}\n{class_entry(name, items[name])}")
    entries = (entry("function", name, items[name], str(signature(items[name]))) for name in functions)
    write_page(folder / "functions.rst", f"{heading('Functions')}\n{''.join(entries)}")
    rows = [(f"[`{name}`](#kindyna.{name})", summary(items[name])) for name in (*functions, *kinds)]
    listed = table("name | what it is", rows) + contents(("functions", *kinds), ":hidden:")
    write_page(folder / "index.md", text("library", listed))


def heading(title: str) -> str:
    """Heading of a page of reStructuredText about the library."""
    return f"{title}\n{'=' * len(title)}\n\n.. py:currentmodule:: kindyna\n"


def summary(item: Any) -> str:
    """First sentence of a docstring, in a cell of a table."""
    first = " ".join(re.split(r"(?<=[^.])\.(?:\s|$)", (item.__doc__ or "").strip(), maxsplit=1)[0].split())
    return re.sub(r"``(.*?)``", lambda mark: code(mark[1]), words(first).replace("&#96;", "`")) + "."


def class_entry(name: str, kind: type) -> str:
    """A class with its members, each with an anchor."""
    sections = docstring(kind)
    meanings = {field.strip(): row for row in sections["Attributes"] for field in row.name.split(",")}
    sections["Attributes"] = []
    parts = []
    for member, item in members(kind):
        if callable(item):
            parts.append(entry("method", member, item, str(signature(item, name))))
        elif isinstance(item, property):
            parts.append(entry("property", member, item, "", type_text(item.fget.__annotations__["return"], name)))
        else:
            meaning = " ".join(meanings[member].desc) or meanings[member].type
            sentence = f"{meaning[:1].upper()}{meaning[1:].rstrip('.')}."
            parts.append(directive("attribute", member, type_text(item, name), sentence))
    return directive(
        "exception" if issubclass(kind, Exception) else "class", name, "", f"{sections}\n\n{''.join(parts)}"
    )


def entry(sort: str, name: str, item: Any, arguments: str, kind: str = "") -> str:
    """A function, method or property with its docstring."""
    return directive(sort, f"{name}{arguments}", kind, str(docstring(item)))


def directive(sort: str, line: str, kind: str, body: str) -> str:
    """A directive of Sphinx about Python, with its text."""
    typed = f"   :type: {kind}\n" if kind else ""
    return f".. py:{sort}:: {line}\n{typed}\n{indent(body, '   ')}\n\n"


def docstring(item: Any) -> SphinxDocString:
    """The docstring, by sections."""
    return SphinxDocString(getdoc(item) or "")


class Written(str):
    """An annotation as it is written."""

    def __repr__(self) -> str:
        return str(self)


def signature(item: Any, owner: str = "") -> inspect.Signature:
    """Signature as it is written, without self."""
    result = inspect.signature(item)
    rows = [
        row.replace(annotation=Written(type_text(row.annotation, owner)))
        for row in result.parameters.values()
        if row.name != "self"
    ]
    return result.replace(parameters=rows, return_annotation=Written(type_text(result.return_annotation, owner)))


def type_text(written: str, owner: str) -> str:
    """An annotation in the words of a reader: public names, and ndarray."""
    names = {"Array": "ndarray", "D": "Design", "Self": owner}
    return re.sub(r"\b(?:Array|D|Self)\b", lambda name: names[name[0]], written)
