"""The command line: ``python -m core COMMAND ...``, and the same behind ``kindyna --headless`` with pictures.

Exit codes: 0 done; 1 done and all files written, but a finding is an error; 2 nothing done.
"""

from __future__ import annotations

from core.process import exit_code, importing

with importing():
    import argparse
    import os
    import sys
    from collections.abc import Callable, Mapping, Sequence
    from types import MappingProxyType
    from typing import Any, NoReturn

    from core import __version__
    from core.commands import COMMANDS, NOTHING_DONE, Command, Painter
    from core.errors import KindynaError
    from core.process import end_at_once, keep_freed_memory
    from core.project.files import inputs_kept

MOST_LINES = 100


class _Formatter(argparse.HelpFormatter):
    """As wide as the terminal, like argparse's own, which imports all that unpacks archives to learn how wide that is."""

    def __init__(self, prog: str) -> None:
        try:
            width = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size(1).columns
        except (ValueError, OSError):  # no terminal
            width = 80
        super().__init__(prog, width=width - 2)


class _Parser(argparse.ArgumentParser):
    """Says what is wrong with the arguments in one line. Adds its own options when it parses for the first time."""

    asks: Callable[[], type] | None = None

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        asks, self.asks = self.asks, None
        if asks is not None:
            from core.requests import add_options

            add_options(self, asks())
        found, rest = super().parse_known_args(args, namespace)
        if rest:  # here, where the command is known whose help tells what there is
            from core.project.reading_faults import did_you_mean

            meant = did_you_mean(rest[0].partition("=")[0], tuple(self._option_string_actions))
            self.error(f"unrecognized arguments: {' '.join(rest)}{meant}")
        return found, rest

    def error(self, message: str) -> NoReturn:
        self.exit(NOTHING_DONE, f"{self.prog}: {message}; see {self.prog} --help\n")


_HOW: Mapping[str, Any] = {"formatter_class": _Formatter, "allow_abbrev": False}


def parser(program: str, rows: Mapping[str, Command] = COMMANDS) -> argparse.ArgumentParser:
    """All commands; each with its options once it is chosen."""
    made = _Parser(prog=program, description="Cam and mechanism design without a window.", **_HOW)
    made.add_argument("--version", action="version", version=f"kindyna {__version__}")
    commands = made.add_subparsers(metavar="COMMAND", required=True, dest="command", prog=program)
    for name, row in rows.items():
        commands.add_parser(name, help=row.help, description=row.help, **_HOW).asks = row.asks
    return made


def main(
    argv: Sequence[str] | None = None,
    painter: Painter | None = None,
    program: str = "python -m core",
    extra: Mapping[str, Command] = MappingProxyType({}),
) -> int:
    """Run one command; returns the exit code. painter paints pictures, None leaves them out; extra: more commands."""
    return exit_code(lambda: _run(argv, painter, program, {**COMMANDS, **extra}))


def _run(argv: Sequence[str] | None, painter: Painter | None, program: str, rows: Mapping[str, Command]) -> int:
    keep_freed_memory()
    end_at_once()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    given = list(sys.argv[1:] if argv is None else argv)
    chosen = {given[0]: rows[given[0]]} if given and given[0] in rows else rows  # the others are made only to be listed
    arguments = parser(program, chosen).parse_args(given)
    row = rows[arguments.command]
    from core.requests import filled

    try:
        with inputs_kept():
            return row.run(filled(row.asks(), vars(arguments)), painter)
    except KindynaError as error:
        from core.commands.common import named_in_file

        lines = str(named_in_file(error, arguments)).split("\n")
        rest = len(lines) - MOST_LINES
        print(
            "\n".join(lines[:MOST_LINES]), *([f"and {rest} more faults"] if rest > 0 else []), sep="\n", file=sys.stderr
        )
        return NOTHING_DONE


if __name__ == "__main__":
    sys.exit(main())
