"""The program: ``kindyna [DESIGN]`` opens the window, ``kindyna --headless COMMAND ...`` never shows one.

Qt is imported inside functions, where something is drawn, and so is the command line of the core: both save start-up time.
"""

from __future__ import annotations

from core.process import exit_code, importing

with importing():
    import argparse
    import sys
    from collections.abc import Callable, Mapping, Sequence
    from dataclasses import replace
    from pathlib import Path
    from types import ModuleType
    from typing import TYPE_CHECKING, Any, NoReturn

    from core import __version__
    from core.errors import KindynaError
    from kindyna_gui.display import missing_library, obstacle
    from kindyna_gui.places import default_design

if TYPE_CHECKING:
    from core.commands import Drawn, Painter

    Run = Callable[[Any, Painter | None], int]

DONE, DONE_WITH_ERRORS, NOTHING_DONE = 0, 1, 2  # exit codes, as those of the core
HEADLESS = "--headless"
OUT = Path("out")
PACKAGES = "libegl1 libgl1 libglib2.0-0 libdbus-1-3 libfontconfig1 libxkbcommon0"
WINDOW_PACKAGES = "libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxkbcommon-x11-0 libxcb-shape0"


class _Parser(argparse.ArgumentParser):
    """Parser that reports wrong arguments in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(NOTHING_DONE, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser() -> argparse.ArgumentParser:
    """Return the parser of the window's command line."""
    result = _Parser(
        prog="kindyna",
        usage="kindyna [DESIGN]\n       kindyna --headless COMMAND ...",
        description="Design of cams and the mechanisms they drive.",
        epilog="kindyna --headless --help lists the commands that work without a window.",
        allow_abbrev=False,
    )
    result.add_argument(
        "design", metavar="DESIGN", nargs="?", type=Path, help="design file (.toml); default: the lift drive"
    )
    result.add_argument("--version", action="version", version=f"kindyna {__version__}")
    result.add_argument(HEADLESS, nargs="*", metavar="COMMAND", help="work without a window; must come first")
    return result


def paint(drawn: Drawn) -> Mapping[str, bytes]:
    """Return the images of a study, a chart or a figure by file name; none, with a line on stderr, where Qt cannot be loaded."""
    try:
        with importing():
            import_qt()
            from kindyna_gui.pictures.film import paint as painted
    except ImportError as error:
        if not _of_qt(error):
            raise
        print(f"pictures left out: {missing(str(error))}", file=sys.stderr)
        return {}
    return painted(drawn)


def _with_qt(run: Run) -> Run:
    """Return a command that prints the reason in one line and does nothing where Qt cannot be loaded."""

    def guarded(arguments: Any, painter: Painter | None) -> int:
        try:
            with importing():  # Qt cannot be interrupted there
                import_qt()
            return run(arguments, painter)
        except ImportError as error:
            if not _of_qt(error):
                raise
            print(missing(str(error)), file=sys.stderr)
            return NOTHING_DONE

    return guarded


def missing(reason: str, packages: str = PACKAGES) -> str:
    """Return what is missing on the machine, and what installs it, in one line."""
    on_linux = sys.platform.startswith("linux")
    remedy = f"on Debian: apt install {packages}" if on_linux else "pip install --force-reinstall PySide6-Essentials"
    return f"{' '.join(reason.split())}; {remedy}"


def without_window(path: Path, why: str) -> int:
    """Print the report and write tables and images to ``out``, where no window can be opened."""
    from core.findings import ERROR
    from core.output.export import files
    from core.output.report import report
    from core.project import load_one
    from core.project.files import write_into
    from core.study import Study, findings_of

    print(f"{why}; no window: the report follows, tables and pictures go to {OUT}/", flush=True)
    study = Study(load_one(path))
    text = report(study)
    content: dict[str, str | bytes] = {"report.txt": text, **files(study), **paint(study)}
    write_into(OUT, content)
    print(text, end="")
    return DONE_WITH_ERRORS if any(f.severity == ERROR for f in findings_of(study)) else DONE


def import_qt() -> None:
    """Import Qt; later modules are then imported as without it. Raises ImportError where a library is missing.

    Qt for Python reads the source of every module that is imported after it, to know whether the optional names of its
    methods, which this program does not use, could be switched on there: a tenth of the start. It compiles the patterns
    of the generator of its stub files, too.
    """
    import builtins

    generator = "shibokensupport.signature.lib.pyi_generator"
    sys.modules.setdefault(generator, ModuleType(generator))
    from PySide6 import QtWidgets  # noqa: F401

    builtins.__import__ = getattr(builtins, "__orig_import__", builtins.__import__)


def window_module() -> ModuleType:
    """Import ``kindyna_gui.window.main_window``. Raises ImportError where a library is missing."""
    with importing():
        import_qt()
        from kindyna_gui.window import main_window

    return main_window


def window(path: Path | None) -> int:
    """Open the window and return the exit code; without its libraries write report, tables and images instead."""
    trouble = ""
    try:
        trouble = missing_library()
        if not trouble:
            main_window = window_module()
    except ImportError as error:
        if not _of_qt(error):
            raise
        trouble = str(error)
    if trouble:
        return without_window(path or default_design(), missing(trouble, f"{PACKAGES} {WINDOW_PACKAGES}"))
    code: int = main_window.run(path)
    return code


def headless(arguments: Sequence[str]) -> int:
    """Run the command line of the core, with the commands that need a hidden window; return the exit code."""
    from core.__main__ import main as core_main
    from kindyna_gui.headless import COMMANDS

    extra = {name: replace(row, run=_with_qt(row.run)) for name, row in COMMANDS.items()}
    return core_main(arguments, painter=paint, program=f"kindyna {HEADLESS}", extra=extra)


def _of_qt(error: ImportError) -> bool:
    """Whether Qt or one of its libraries is missing, and not a part of this program."""
    library = any(kind in str(error) for kind in (".so", ".dylib", "DLL"))
    return library or (error.name or "").split(".")[0] in ("PySide6", "shiboken6", "pyqtgraph")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the program and return the exit code."""
    return exit_code(lambda: _run(list(sys.argv[1:] if argv is None else argv)))


def _run(arguments: list[str]) -> int:
    if arguments[:1] == [HEADLESS]:
        return headless(arguments[1:])
    options = parser().parse_args(arguments)
    if options.headless is not None:
        parser().error(f"{HEADLESS} must come first")
    path: Path | None = options.design
    why = obstacle()
    try:
        return without_window(path or default_design(), why) if why else window(path)
    except KindynaError as error:
        print(error, file=sys.stderr)
        return NOTHING_DONE


if __name__ == "__main__":
    sys.exit(main())
