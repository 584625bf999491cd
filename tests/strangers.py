"""Rows that nobody here knows, each put into one table of the source before anything reads it: ``pytest -p strangers``."""

import ast
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import CodeType, ModuleType

ADDED = {
    "core.laws.table": {
        "_ROWS": """Law("trefoil", "Trefoil", SERIES, _single_piece(0.0, 0.0, 0.0, 4.0, -3.0), ("s = 4 u³ - 3 u⁴",),
                        "Stranger 2000: s = 4u^3 - 3u^4", "TRE")""",
    },
    "core.units": {
        "_ROWS": """UnitKind("flow", {"l/min": _ONE / 60000, "m³/h": _ONE / 3600}, {"l_per_min": "l/min"}, {"ml/min": _MICRO / 60},
                             shown={"l/min": (("l/min", 0.5), ("ml/min", 0.0))})""",
    },
    "core.study.quantities": {
        "_ROWS": """Quantity("squeeze", "squeeze_n", "Squeeze", "S", "force", "dynamics",
                             lambda s: 2.0 * s.dynamics.contact, needs="cam")""",
    },
    "core.design.limits": {
        "Limits": """jerk_mm_s3: float | None = _most("Jerk", "greatest of the follower", Bounds(("jerk",), "take a gentler law"))
squeeze_n: float | None = _most("Squeeze", "greatest on the follower", Bounds(("squeeze",), "press less"))""",
    },
    "core.design.parts": {"Loads": """oil_l_per_min: float = number("Oil", 0.0, default=0.0)"""},
}
"""Module -> table, or class -> its further row, or field."""


class WithRows(SourceFileLoader):
    def get_code(self, fullname: str) -> CodeType:
        tree = ast.parse(self.get_data(self.path))
        for name, added in ((name, each) for name, text in ADDED[fullname].items() for each in ast.parse(text).body):
            for node in tree.body:
                match node, added:
                    case ast.ClassDef(name=found), _ if found == name:
                        node.body.append(added)
                    case (
                        (
                            ast.Assign(targets=[ast.Name(id=found)], value=ast.Tuple(elts=rows))
                            | ast.AnnAssign(target=ast.Name(id=found), value=ast.Tuple(elts=rows))
                        ),
                        ast.Expr(),
                    ) if found == name:
                        rows.append(added.value)
        return compile(ast.fix_missing_locations(tree), self.path, "exec", dont_inherit=True)


class Finder(MetaPathFinder):
    def find_spec(self, fullname: str, path: object = None, target: ModuleType | None = None) -> ModuleSpec | None:
        spec = PathFinder.find_spec(fullname, path) if fullname in ADDED else None
        if spec is not None and spec.origin is not None:
            spec.loader = WithRows(fullname, spec.origin)
        return spec


sys.meta_path.insert(0, Finder())
