"""Command line: ``python -m core COMMAND ...``, and ``kindyna --headless COMMAND ...``, which writes images too.

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
    from core.process import keep_freed_memory, skip_last_collection
    from core.project.files import inputs_protected

MOST_LINES = 100


class _Formatter(argparse.HelpFormatter):
    """Help as wide as the terminal; argparse imports ``shutil``, and with it the archive modules, only to read that width."""

    def __init__(self, prog: str) -> None:
        try:
            width = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size(1).columns
        except (ValueError, OSError):  # no terminal
            width = 80
        super().__init__(prog, width=width - 2)


class _Parser(argparse.ArgumentParser):
    """Reports wrong arguments in one line, and adds the options of its request when it first parses."""

    request: Callable[[], type] | None = None

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        request, self.request = self.request, None
        if request is not None:
            from core.requests import add_options

            add_options(self, request())
        result, rest = super().parse_known_args(args, namespace)
        if rest:  # checked in the command's parser, whose help lists the options
            from core.project.reading_faults import did_you_mean

            suggestion = did_you_mean(rest[0].partition("=")[0], tuple(self._option_string_actions))
            self.error(f"unrecognized arguments: {' '.join(rest)}{suggestion}")
        return result, rest

    def error(self, message: str) -> NoReturn:
        self.exit(NOTHING_DONE, f"{self.prog}: {message}; see {self.prog} --help\n")


_PARSER_OPTIONS: Mapping[str, Any] = {"formatter_class": _Formatter, "allow_abbrev": False}


def parser(program: str, rows: Mapping[str, Command] = COMMANDS) -> argparse.ArgumentParser:
    """Parser of all commands; a command adds its options when it is parsed."""
    result = _Parser(prog=program, description="Cam and mechanism design without a window.", **_PARSER_OPTIONS)
    result.add_argument("--version", action="version", version=f"kindyna {__version__}")
    commands = result.add_subparsers(metavar="COMMAND", required=True, dest="command", prog=program)
    for name, row in rows.items():
        commands.add_parser(name, help=row.help, description=row.help, **_PARSER_OPTIONS).request = row.arguments
    return result


def main(
    argv: Sequence[str] | None = None,
    painter: Painter | None = None,
    program: str = f"python -m {(__package__ or '').partition('.')[0]}",
    extra: Mapping[str, Command] = MappingProxyType({}),
) -> int:
    """Run one command; returns the exit code. Without a painter no images are written; extra: further commands."""
    return exit_code(lambda: _run(argv, painter, program, {**COMMANDS, **extra}))


def _run(argv: Sequence[str] | None, painter: Painter | None, program: str, rows: Mapping[str, Command]) -> int:
    keep_freed_memory()
    skip_last_collection()
    words = list(sys.argv[1:] if argv is None else argv)
    needed = {words[0]: rows[words[0]]} if words and words[0] in rows else rows  # all are built only to be listed
    arguments = parser(program, needed).parse_args(words)
    row = rows[arguments.command]
    from core.requests import build_request

    try:
        with inputs_protected():
            return row.run(build_request(row.arguments(), vars(arguments)), painter)
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
