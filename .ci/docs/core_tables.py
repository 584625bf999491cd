"""Tables of core as pages: laws, quantities, findings, fields, commands, controllers."""

import re
from argparse import ArgumentParser, HelpFormatter
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from markup import code, contents, equation, table, text, words, write_page

from core.commands import COMMANDS
from core.design import Design, Entry, entries, only
from core.findings import ROWS
from core.laws import LAWS
from core.laws.table import Law, peaks
from core.number_text import typeset
from core.output.controllers.rows import shipped_controllers
from core.output.lines import digits
from core.project import load
from core.project.reading_faults import subjects
from core.requests import add_options
from core.study.quantities import OF_MEMBERS, QUANTITIES, Quantity
from core.units import split_unit


def reference(folder: Path) -> None:
    """Write the pages of all tables."""
    pages = {
        "laws": laws,
        "quantities": quantities,
        "findings": findings,
        "commands": commands,
        "controllers": controllers,
    }
    for name, page in pages.items():
        write_page(folder / f"{name}.md", text(name, page()))
    write_page(folder / "index.md", f"# Tables\n\n{contents(pages)}")


def laws() -> str:
    """Motion laws by group."""
    header = "law | in files | equation | velocity | acceleration | jerk | torque | source"
    groups = dict.fromkeys(law.group for law in LAWS.values())
    rows = {group: [law_cells(slug, law) for slug, law in LAWS.items() if law.group == group] for group in groups}
    return "\n\n".join(f"## {group}\n\n{table(header, cells)}" for group, cells in rows.items())


def law_cells(slug: str, law: Law) -> tuple[str, ...]:
    """Cells of a law: equation, peak values, and its publication where its source is not the formula alone."""
    values: tuple[str, ...] = ("", "", "", words(law.own))
    if law.pieces:
        peak = peaks(law)
        values = tuple(map(digits, (peak.cv, peak.ca, peak.cj, peak.cm)))
    publication = law.source.partition(":")[0]
    where = f"<br>{words(law.where)}" if law.where else ""
    source = "" if "=" in publication else words(publication)
    return words(law.label), code(slug), equation(law.formula) + where, *values, source


def quantities() -> str:
    """Quantities of studies by the file of their columns."""
    rows = [row for row in (*QUANTITIES.values(), *(row for rows in OF_MEMBERS.values() for row in rows)) if row.slug]
    files = {
        name: [quantity_cells(row) for row in rows if row.table == name]
        for name in dict.fromkeys(row.table for row in rows)
    }
    header = "channel | quantity | symbol | unit | equation | source"
    return "\n\n".join(f"## {name}\n\n{table(header, cells)}" for name, cells in files.items())


def quantity_cells(row: Quantity) -> tuple[str, ...]:
    """Cells of a quantity; with its equation under a straight face, where that is another."""
    lines = [line for line in (row.equation, row.flat) if line]
    unit = "of the motion" if "{m}" in row.slug else row.unit.symbol
    return code(row.column), words(row.label), words(row.symbol), words(unit), equation(lines), words(row.source)


def findings() -> str:
    """Codes, severities and sentences of findings, whose values are named in italics."""

    def value(name: re.Match[str]) -> str:
        return " at <i>angle</i>" if name[1] == "at" else f"<i>{split_unit(name[1])[0].replace('_', ' ')}</i>"

    rows = (
        (
            code(name),
            words(" or ".join(row.severities)),
            re.sub(r"{(\w+)[^}]*}", value, words(row.sentence).replace("&#95;", "_")),
        )
        for name, row in ROWS.items()
    )
    return table("code | severity | sentence, with its remedy", rows)


def fields() -> str:
    """Fields of all examples by table of the file, with the kinds of designs that have them."""
    rows: dict[str, dict[tuple[str, ...], dict[str, None]]] = {}
    for design in designs():
        for name in design.tables:
            for entry in entries(design, name):
                kinds = rows.setdefault(name.partition("[")[0], {}).setdefault(field_cells(entry), {})
                kinds["shaft" if design.listed else design.drive.kind] = None
    header = "path | field | what it is | allowed | in designs of kind"
    cells = {name: [(*cells, ", ".join(kinds)) for cells, kinds in fields.items()] for name, fields in rows.items()}
    return "\n\n".join(f"## [{name}]\n\n{table(header, lines)}" for name, lines in cells.items())


def designs() -> Iterator[Design]:
    """The examples, and each drive of those that list drives."""
    for _, examples in subjects():
        for row in examples:
            design = load(row.path)
            yield design
            yield from (only(design, i) for i in range(len(design.drives)) if design.listed)


def field_cells(entry: Entry) -> tuple[str, ...]:
    """Cells of a field, for any row of a list and any point of a link."""
    path = re.sub(r"\.points\.\w+\.", ".points.NAME.", re.sub(r"\[\d+\]", "[i]", entry.path))
    return code(path), words(entry.info.label), words(typeset(entry.info.help)), words(entry.info.allowed(entry.unit))


def commands() -> str:
    """Commands with their options, as ``--help`` prints them."""
    from kindyna_gui import headless

    wide, parts = partial(HelpFormatter, width=110), []
    for name, row in {**COMMANDS, **headless.COMMANDS}.items():
        parser = ArgumentParser(prog=f"kindyna --headless {name}", description=row.help, formatter_class=wide)
        add_options(parser, row.arguments())
        parts.append(f"## {name}\n\n```text\n{parser.format_help()}```")
    return "\n\n".join(parts)


def controllers() -> str:
    """Controllers with the format of their files."""
    rows = (
        (
            words(row.label), code(row.slug), words(", ".join(row.interpolation)), words(", ".join(row.columns)),
            f"{row.rows[0]} … {row.rows[1]}", "equal" if row.equal_steps else "placed", code(row.extension), words(row.source),
            words("; ".join(row.open)),
        )
        for row in shipped_controllers().values()
    )  # fmt: skip
    return table("controller | slug | between two rows | columns | rows | steps | file | source | open questions", rows)
