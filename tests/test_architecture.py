"""The house, read off the syntax trees: who asks what kind of design this is, how full a folder is, and who knows Qt."""

import ast
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import get_args

import pytest

from core.design import FOLLOWER_KINDS, parts

ROOT = Path(__file__).parents[1]


@lru_cache(maxsize=1)
def sources() -> dict[Path, str]:
    """Texts, not trees: those are millions of objects that every search for rubbish would go through from then on."""
    return {
        path: path.read_text("utf-8")
        for room in ("core", "kindyna_gui")
        for path in sorted((ROOT / room).rglob("*.py"))
    }


def statements(tree: ast.Module) -> Iterator[ast.AST]:
    """All statements, those within functions and classes too; what stands inside an expression is none."""
    left: list[ast.AST] = [tree]
    while left:
        node = left.pop()
        yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            left.extend(getattr(node, part, ()))


MOST_FILES = 40
OF_QT = {"PySide6", "shiboken6", "pyqtgraph", "kindyna_gui"}

# -- what kind of design this is ---------------------------------------------------------------------------

ALLOWED = ("core.design", "core.project", "core.followers")
KINDS = {"Follower", "Linkage"} | {kind.__name__ for kind in get_args(parts.Follower)}
KINDS |= {part.__name__ for row in FOLLOWER_KINDS.values() for part in (row.follower, row.loads, *(row.flat or ()))} | {
    "LinkageLoads"
}
SLUGS = {"linkage", *FOLLOWER_KINDS}

EXCEPTIONS: dict[str, tuple[str, ...]] = {
    "files and reports call the angle, the kind and the lengths by the name of the kind, which is promised": (
        "kindyna_gui.forms.parameters_view.kind_label",
    ),
    "centres, their constructions and velocities go by the numbers of links, which only listed links have": (
        "kindyna_gui.linkage.centres_view.CircleView.refresh",
        "kindyna_gui.linkage.centres_view.PolygonView._rows",
        "kindyna_gui.pictures.drawing.parts.available_layers",
        "kindyna_gui.pictures.drawing.geometry.Geometry.__init__",
        "kindyna_gui.requirements.require_centres",
        "kindyna_gui.requirements.require_links",
        "kindyna_gui.window.layouts.Layouts._kinds_of_design",
    ),
    "a menu or a group of the gallery belongs to one kind: the links of a linkage": (
        "kindyna_gui.window.linkage_menus._linkage",
        "kindyna_gui.window.gallery.presets",
    ),
}
"""Reason: the functions that may ask what kind of design they have."""


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


ASKING = re.compile(rf"is_linkage|lists_links|require_links|\b({'|'.join(KINDS)})\b")
KIND, SLUG = re.compile(r"\bkind(_of)?\b"), re.compile(rf"""['"]({"|".join(SLUGS)})['"]""")
QT = re.compile(rf"\b({'|'.join(OF_QT)})\b")


def names_in(node: ast.AST) -> set[str]:
    """Every name that an expression mentions, attributes included."""
    inside = list(ast.walk(node))
    return {n.id for n in inside if isinstance(n, ast.Name)} | {n.attr for n in inside if isinstance(n, ast.Attribute)}


def texts_in(node: ast.AST) -> set[str]:
    return {n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and isinstance(n.value, str)}


def asks_kind(node: ast.AST) -> bool:
    """``x.is_linkage``, ``is_linkage(x)``, ``isinstance(x, Kind)``, ``type(x) is Kind``, ``x.kind == "slug"``, ``case Kind()``."""
    match node:
        case ast.Attribute(attr="is_linkage", ctx=ast.Load()):
            return True
        case ast.Call(func=ast.Name(id="is_linkage" | "lists_links" | "require_links")):
            return True
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, kind]):
            return bool(names_in(kind) & KINDS)
        case ast.Compare():
            return bool(names_in(node) & KINDS) or bool(names_in(node) & {"kind", "kind_of"} and texts_in(node) & SLUGS)
        case ast.MatchClass(cls=kind):
            return bool(names_in(kind) & KINDS)
    return False


def who_asks(tree: ast.AST, place: str) -> Iterator[str]:
    """The functions, with their module and class, that ask for the kind."""
    for node in ast.iter_child_nodes(tree):
        if asks_kind(node):
            yield place
        named = isinstance(node, ast.FunctionDef | ast.ClassDef)
        yield from who_asks(node, f"{place}.{node.name}" if named else place)


def test_only_design_project_and_followers_ask_what_kind_of_design_it_is() -> None:
    """Everyone else asks whether the design has a motion, a cam, a slider."""
    asking = set()
    for path, text in sources().items():
        module = module_of(path)
        may_ask = ASKING.search(text) or (KIND.search(text) and SLUG.search(text))
        if not module.startswith(ALLOWED) and may_ask:  # the walk takes long
            asking |= set(who_asks(ast.parse(text), module))
    excepted = [place for places in EXCEPTIONS.values() for place in places]
    assert sorted(asking - set(excepted)) == [], "ask for what the design has, not for its kind"
    assert sorted(set(excepted) - asking) == [], "no longer there: take them off the list of exceptions"
    assert len(excepted) == len(set(excepted))


@pytest.mark.parametrize(
    ("source", "asks"),
    [
        ("design.drive.is_linkage", True),
        ("is_linkage(design)", True),
        ("isinstance(follower, CamSlider)", True),
        ("isinstance(drive.mechanism, (design.Translating, int))", True),
        ("type(follower) is Oscillating", True),
        ("drive.kind == 'linkage'", True),
        ("kind_of(follower) in ('cam-slider', 'translating')", True),
        ("match follower:\n    case Translating(): pass", True),
        ("isinstance(law, Named)", False),
        ("drive.cam is None", False),
        ("finding.kind == 'error'", False),
        ("FOLLOWERS[type(follower)].build(follower)", False),
    ],
)
def test_a_question_for_the_kind_is_seen(source: str, asks: bool) -> None:
    assert bool(list(who_asks(ast.parse(source), ""))) is asks


# -- folders and imports -----------------------------------------------------------------------------------


def test_no_folder_is_too_full_to_be_looked_through() -> None:
    full = {path.parent for room in ("core", "kindyna_gui") for path in (ROOT / room).rglob("*.py")}
    counts = {str(folder.relative_to(ROOT)): len(list(folder.glob("*.py"))) for folder in full}
    assert {folder: count for folder, count in counts.items() if count > MOST_FILES} == {}


def test_the_core_does_not_know_the_window() -> None:
    """Wherever an import stands: in a function, too."""
    found = set()
    for path, text in sources().items():
        if module_of(path).startswith("core") and QT.search(text):
            for node in statements(ast.parse(text)):
                if isinstance(node, ast.Import):
                    found |= {
                        (module_of(path), alias.name) for alias in node.names if alias.name.partition(".")[0] in OF_QT
                    }
                elif isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] in OF_QT:
                    found.add((module_of(path), node.module))
    assert found == set()


def imports_and_views() -> tuple[dict[str, set[str]], dict[str, set[str]]]:
    """Module of the window -> those that it imports, wherever the import stands, for types too; module -> the views in it:
    classes that descend from ``View`` and that no other class descends from."""
    texts = {module_of(path): text for path, text in sources().items() if module_of(path).startswith("kindyna_gui")}
    imports: dict[str, set[str]] = {}
    bases: dict[str, set[str]] = {}
    places: dict[str, str] = {}
    for module, text in texts.items():
        names: set[str] = set()
        for node in statements(ast.parse(text)):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
            elif isinstance(node, ast.ClassDef):
                bases[node.name] = set().union(*map(names_in, node.bases))
                places[node.name] = module
        imports[module] = names & texts.keys()
    views, grown = set(), {"View"}
    while grown:
        views |= grown
        grown = {name for name, own in bases.items() if own & views} - views
    found: dict[str, set[str]] = {}
    for name in views - set().union(*bases.values()):
        found.setdefault(places[name], set()).add(name)
    return imports, found


def test_no_view_imports_another() -> None:
    """Nor by way of others. They meet in the session, the player and what the window lets them ask."""
    imports, views = imports_and_views()
    assert len(views) >= 20
    reached = {}
    for view in views:
        there, new = set(), {view}
        while new:
            there |= new
            new = set().union(*(imports[module] for module in new)) - there
        reached[view] = sorted((there & views.keys()) - {view})
    assert {view: others for view, others in reached.items() if others} == {}


@pytest.mark.parametrize("page", [".github/CONTRIBUTING.md", "resources/help/architecture.md"])
def test_files_that_are_named_to_a_reader_are_there(page: str) -> None:
    named = re.findall(r"`((?:core|kindyna_gui|tests|resources)/[\w/.]+)`", (ROOT / page).read_text("utf-8"))
    assert [path for path in named if not (ROOT / path).exists()] == []


# -- docstrings --------------------------------------------------------------------------------------------

ARRAY = re.compile(r"\bndarray\b")
ACCESSORS = {"property", "cached_property", "Lazy", "lazy", "overload"}


def public_functions(tree: ast.AST) -> Iterator[ast.FunctionDef]:
    """Functions of a module and methods of its classes whose names are public; accessors have one line and are left out."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node)
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            accessor = any(names_in(decorator) & ACCESSORS for decorator in node.decorator_list)
            yield from () if accessor else (node,)


def entries(docstring: str, section: str) -> dict[str, str]:
    """Name -> the entry of a section of numpydoc: what follows the name, and the indented lines below."""
    found = re.search(rf"^{section}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", docstring, re.M | re.S)
    result: dict[str, str] = {}
    names: list[str] = []
    for line in (found[1] if found else "").splitlines():
        if line and not line.startswith(" "):
            head, _, kind = line.partition(" : ")
            names = [name.strip(" *`") for name in re.sub(r"\[.*?\]|\(.*?\)", "", head).split(",")] if kind else [""]
            result |= dict.fromkeys(names, kind or line)
        else:
            result |= {name: f"{result[name]}\n{line}" for name in names}
    return result


def measured(entry: str) -> bool:
    """Whether an entry names the shape of an array, and its unit or that it has none."""
    return bool(re.search(r"\([^()]*(?:,|\.\.\.)[^()]*\)", entry) and re.search(r"\[[^\]]+\]|dimensionless", entry))


def undocumented(function: ast.FunctionDef) -> list[str]:
    """The arrays of a function whose shape or unit its docstring does not name; "return" for what it returns."""
    docstring = ast.get_docstring(function) or ""
    parameters, returned = entries(docstring, "Parameters"), entries(docstring, "Returns")
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    arrays = [one.arg for one in arguments if one.annotation and ARRAY.search(ast.unparse(one.annotation))]
    missing = [name for name in arrays if not measured(parameters.get(name, ""))]
    gives = function.returns is not None and ARRAY.search(ast.unparse(function.returns))
    return missing + (["return"] if gives and not any(map(measured, returned.values())) else [])


def test_every_array_of_a_public_function_has_its_shape_and_unit() -> None:
    missing = {}
    for path, text in sources().items():
        place = path.relative_to(ROOT).as_posix()
        if place.startswith("core/") and "ndarray" in text:
            for function in public_functions(ast.parse(text)):
                if arrays := undocumented(function):
                    missing[f"{place}: {function.name}"] = arrays
    assert missing == {}, "name : ndarray (shape) [unit], or dimensionless, under Parameters and Returns"


@pytest.mark.parametrize(
    ("body", "missing"),
    [
        ("One line.", ["x", "return"]),
        ("S.\n\nParameters\n----------\nx : ndarray (n,) [mm]\n\nReturns\n-------\nndarray (n,), dimensionless", []),
        ("S.\n\nParameters\n----------\nx : ndarray (n,)\n    Force.\n\nReturns\n-------\nndarray (n,) [N]", ["x"]),
        ("S.\n\nParameters\n----------\nx : ndarray [N]\n\nReturns\n-------\ny, z : ndarray (n, 2) [N]", ["x"]),
    ],
)
def test_a_missing_shape_or_unit_is_seen(body: str, missing: list[str]) -> None:
    tree = ast.parse(f"def f(x: np.ndarray) -> np.ndarray:\n    {body!r}\n")
    assert [undocumented(function) for function in public_functions(tree)] == [missing]


# -- other systems -----------------------------------------------------------------------------------------

ENCODING_AT = {"read_text": 0, "write_text": 1}
"""Method of a path -> number of its argument ``encoding``."""
PROCESS = {"run", "Popen", "check_output"}


def opened_by_the_systems_rules(source: str, product: bool = False) -> list[str]:
    """Calls that open a text without its encoding, or, in the product, write one with the system's ends of lines."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute | ast.Name):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
        named = {word.arg: word.value for word in node.keywords}
        mode = next(iter([*node.args[1:2], *([named["mode"]] if "mode" in named else [])]), None)
        is_binary = isinstance(mode, ast.Constant) and "b" in str(mode.value)
        opens = (
            (name in ENCODING_AT and len(node.args) <= ENCODING_AT[name])
            or (isinstance(node.func, ast.Name) and name == "open" and node.args and not is_binary)
            or (name in PROCESS and "text" in named)
        )
        if (opens and "encoding" not in named) or (product and name == "write_text" and "newline" not in named):
            found.append(ast.unparse(node))
    return found


def test_every_text_is_opened_with_its_encoding_and_the_product_writes_its_own_ends_of_lines() -> None:
    found = {}
    for room in ("core", "kindyna_gui", ".ci", "tests"):
        for path in sorted((ROOT / room).rglob("*.py")):
            text = path.read_text("utf-8")
            if re.search(r"_text\(|\bopen\(|\btext=", text):  # the walk takes long
                found[path.relative_to(ROOT).as_posix()] = opened_by_the_systems_rules(text, room != "tests")
    assert {path: calls for path, calls in found.items() if calls} == {}


@pytest.mark.parametrize(
    ("line", "seen"),
    [
        ("path.read_text()", True),
        ("path.write_text(text)", True),
        ("open(path)", True),
        ("open(path, 'w')", True),
        ("subprocess.run(words, text=True)", True),
        ("path.write_text(text, 'utf-8')", True),
        ("path.write_text(text, 'utf-8', newline='\\n')", False),
        ("path.read_text(encoding='utf-8', errors='replace')", False),
        ("open(handle, 'rb')", False),
        ("subprocess.run(words, input=data)", False),
        ("dialog.open()", False),
    ],
)
def test_a_text_opened_by_the_systems_rules_is_seen(line: str, seen: bool) -> None:
    assert bool(opened_by_the_systems_rules(line, product=True)) is seen


POSIX = re.compile(
    r"\.(symlink_to|readlink|mkfifo|fork|wait4|geteuid|seteuid|setrlimit|SIGKILL|SIGHUP|AF_UNIX|tzset|umask|chmod)\b"
    r"|\bos\.link\(|['\"](/dev/\w+|sh|mount|SIGKILL|SIGHUP)['\"]"
)
SAID = re.compile(r"\bposix\b|\bskip|\bimportorskip\b")


def needing_posix(source: str) -> list[str]:
    """Tests that need what Windows lacks, by themselves or by what they use of their module, and do not say so."""
    tree = ast.parse(source)
    parts = {getattr(node, "name", "") or ast.unparse(node).split(" = ")[0]: node for node in tree.body}
    if any(SAID.search(ast.unparse(node)) for node in tree.body if isinstance(node, ast.Expr | ast.If)):
        return []
    if "pytestmark" in parts and SAID.search(ast.unparse(parts["pytestmark"])):
        return []
    used = {
        name: names_in(node) | {n.arg for n in ast.walk(node) if isinstance(n, ast.arg)} for name, node in parts.items()
    }
    needing = {name for name, node in parts.items() if POSIX.search(ast.unparse(node))}
    saying = {name for name, node in parts.items() if SAID.search(ast.unparse(node))}
    while more := {name for name in parts if used[name] & needing} - needing:
        needing |= more
    tests = {name for name in needing if name.startswith("test_")} - saying
    return sorted(name for name in tests if not used[name] & saying)


def test_tests_that_need_posix_say_so() -> None:
    found = {}
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        text = path.read_text("utf-8")
        if POSIX.search(text):
            found[path.relative_to(ROOT).as_posix()] = needing_posix(text)
    assert {path: tests for path, tests in found.items() if tests} == {}, "mark them: @pytest.mark.posix('links')"


@pytest.mark.parametrize(
    ("source", "tests"),
    [
        ("def test_a(): path.symlink_to('b')", ["test_a"]),
        (
            "def _pipe(): os.mkfifo('a')\n@pytest.mark.parametrize('make', [_pipe])\ndef test_a(make): make()",
            ["test_a"],
        ),
        ("@pytest.fixture\ndef pipe(): os.mkfifo('a')\ndef test_a(pipe): pass\ndef test_b(): pass", ["test_a"]),
        ("@pytest.mark.posix('links')\ndef test_a(): path.symlink_to('b')", []),
        ("pytestmark = pytest.mark.posix('links')\ndef test_a(): path.symlink_to('b')", []),
        ("links = pytest.mark.posix('links')\n@links\ndef test_a(): path.symlink_to('b')", []),
    ],
)
def test_a_test_that_needs_posix_is_seen(source: str, tests: list[str]) -> None:
    assert needing_posix(source) == tests


# -- tests -------------------------------------------------------------------------------------------------

PRIVATE = re.compile(r"(?P<owner>[\w.)\]]+)\._[a-z]|^\s*from (?P<module>\S+) import .*\b_[a-z]")
OWN = {"self", "cls", "os", "sys"}  # of a test's own class; Python calls some of its functions so


def private_uses(text: str) -> list[str]:
    """Lines that reach for a name of somebody else that begins with an underscore."""
    return [
        line.strip()
        for line in text.splitlines()
        if any((found["owner"] or found["module"]) not in OWN for found in PRIVATE.finditer(line))
    ]


def test_no_test_reaches_into_what_is_private() -> None:
    """They go through files, commands, studies and the window, so that the code behind may be written anew."""
    tests = (path for path in sorted((ROOT / "tests").rglob("*.py")) if path != Path(__file__))
    found = {str(path.relative_to(ROOT)): private_uses(path.read_text("utf-8")) for path in tests}
    assert {path: lines for path, lines in found.items() if lines} == {}, "test what is shown or said instead"


@pytest.mark.parametrize(
    ("line", "private"),
    [
        ("assert view.plot._message.text", True),
        ("wait_for(lambda: not self.dialog._soon.isActive())", True),
        ("graph(user)._changed()", True),
        ("from core.mechanism.groups import _begin", True),
        ("self._values.append(1)", False),
        ("sys._current_frames()", False),
        ("from core.laws import LAWS", False),
    ],
)
def test_a_private_use_is_seen(line: str, private: bool) -> None:
    assert bool(private_uses(line)) is private
