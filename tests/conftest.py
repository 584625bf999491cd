"""What every test gets: no display, English, settings of its own, empty caches."""

import gc
import itertools
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest
from hypothesis.database import DirectoryBasedExampleDatabase

from kindyna_gui.background import tidy

GUI_TESTS = Path(__file__).parent / "gui"
EXAMPLES = 25  # of each property, others at each run

# Before Qt is imported. A test of a real window starts its own display and says so by KINDYNA_TEST_XVFB.
if not os.environ.get("KINDYNA_TEST_XVFB"):
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
for name in (
    "QT_API",
    "QT_FONT_DPI",
    "QT_PLUGIN_PATH",
    "QT_QPA_PLATFORMTHEME",
    "QT_QPA_PLATFORM_PLUGIN_PATH",
    "QT_SCALE_FACTOR",
    "QT_SCREEN_SCALE_FACTORS",
    "QT_STYLE_OVERRIDE",
    "PYQTGRAPH_QT_LIB",
    "LANGUAGE",
):
    os.environ.pop(name, None)
os.environ["LC_ALL"] = "C.UTF-8"
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as core asks for; hypothesis may import numpy first

# Examples that failed are remembered outside the checkout, for each user apart.
user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "")
hypothesis_home = Path(tempfile.gettempdir()) / f"kindyna-hypothesis-{user}"
os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(hypothesis_home)
hypothesis.settings.register_profile(
    "kindyna",
    deadline=None,
    max_examples=EXAMPLES,
    print_blob=True,
    database=DirectoryBasedExampleDatabase(hypothesis_home / "examples"),
)
hypothesis.settings.register_profile(
    "kindyna-ci", deadline=None, max_examples=EXAMPLES, print_blob=True, derandomize=True
)
hypothesis.settings.load_profile("kindyna-ci" if os.environ.get("CI") else "kindyna")


def pytest_configure() -> None:
    """Rubbish is taken away between tests: the thread by which xdist hears of the next ones would take widgets along."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Modules and tests stay: whoever looks for rubbish need not look through them, now or later."""
    gc.freeze()


def pytest_runtest_teardown() -> None:
    """What is due by now."""
    tidy()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """What needs POSIX is left out on Windows. pyqtgraph drops mouse moves less than 10 ms apart, and a test moves faster than that."""
    needing = item.get_closest_marker("posix")
    if needing is not None and sys.platform == "win32":
        pytest.skip(f"POSIX only: {', '.join(needing.args)}")
    if item.path.is_relative_to(GUI_TESTS):
        from kindyna_gui.pictures.plots.library import pg as pyqtgraph
    else:
        pyqtgraph = sys.modules.get("pyqtgraph")
    if pyqtgraph is not None:
        pyqtgraph.setConfigOption("mouseRateLimit", -1)


@pytest.fixture(scope="session")
def homes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """One empty home directory after the other."""
    parent = tmp_path_factory.mktemp("homes")
    return (parent / str(number) for number in itertools.count())


@pytest.fixture(autouse=True)
def own_settings(homes: Iterator[Path]) -> Iterator[Path]:
    """Give each test an empty home, apart from its tmp_path. Folders within it come to be where they are needed."""
    home = next(homes)
    home.mkdir()
    with pytest.MonkeyPatch.context() as environment:
        for variable, folder in (
            ("HOME", "."),
            ("USERPROFILE", "."),
            ("APPDATA", "AppData/Roaming"),
            ("LOCALAPPDATA", "AppData/Local"),
            ("XDG_CONFIG_HOME", ".config"),
            ("XDG_DATA_HOME", ".local/share"),
            ("XDG_STATE_HOME", ".local/state"),
            ("XDG_CACHE_HOME", ".cache"),
        ):
            environment.setenv(variable, str(home / folder))
        yield home


@pytest.fixture(autouse=True)
def fresh_caches() -> None:
    """No test profits from what another has computed."""
    from core import study

    study.clear_caches()
