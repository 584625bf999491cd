"""Lines of formulas as the MathML that is typeset of them: evaluated with values of their symbols, and read for their symbols."""

import math
from collections.abc import Iterable, Mapping
from xml.etree import ElementTree

from core.output.report.formula import mathml

FUNCTIONS = {
    name: getattr(math, f"a{name.removeprefix('arc')}" if name.startswith("arc") else name)
    for name in ("sin", "cos", "tan", "atan2", "arcsin", "arccos", "arctan")
} | {"max": max, "min": min}
OPERATORS = {"−": "-", "⋅": "*", "×": "*"}
CONSTANTS = {"π", "e", "i", "d", "∂", "arg", "sgn", *FUNCTIONS}  # d: of a differential
NAMESPACE = ' xmlns="http://www.w3.org/1998/Math/MathML"'


def tree(line: str) -> ElementTree.Element:
    """The row of a line's MathML."""
    return ElementTree.fromstring(mathml(line).replace(NAMESPACE, ""))[0]


def key(node: ElementTree.Element) -> str:
    """Text and tags of a symbol, by which it is found again in a line."""
    tags = "".join(part.tag[-3:] for part in node.iter() if part.tag not in ("mrow", "math"))
    return f"{''.join(node.itertext()).strip()}|{tags}"


def symbol_key(symbol: str) -> str:
    """The key of a symbol by itself."""
    return key(tree(symbol)[0]) if len(tree(symbol)) == 1 else key(tree(symbol))


def base_and_index(node: ElementTree.Element) -> ElementTree.Element:
    """A symbol with an index, without the power that is typeset with it."""
    symbol = ElementTree.Element("msub")
    symbol.extend(node[:2])
    return symbol


class Evaluator:
    """Evaluates the right side of a line: neighbouring factors are a product."""

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values = {symbol_key(symbol): value for symbol, value in values.items()}

    def value(self, line: str) -> float:
        right = line.partition(" = ")[2]
        result: float = eval(self.row(tree(right)), {"math": math, "f": FUNCTIONS, "abs": abs})
        return result

    def row(self, node: ElementTree.Element) -> str:
        text, after_factor = "", False
        for part in node:
            if part.tag == "mspace":
                continue
            if part.tag == "mo" and part.get("fence") is None:
                sign = (part.text or "").strip()
                text += OPERATORS.get(sign, sign)
                after_factor = False
                continue
            text += ("*" if after_factor else "") + self.factor(part)
            after_factor = True
        return text

    def factor(self, node: ElementTree.Element) -> str:
        value = self.values.get(key(node))
        if value is not None:
            return f"({value!r})"
        inside = [part for part in node if part.tag != "mspace"]
        match node.tag:
            case "mn":
                return {"½": "0.5", "¼": "0.25"}.get(node.text or "", node.text or "")
            case "mi" if node.text == "π":
                return "math.pi"
            case "mfrac":
                return f"(({self.factor(inside[0])})/({self.factor(inside[1])}))"
            case "msup":
                return f"({self.factor(inside[0])})**({self.factor(inside[1])})"
            case "msubsup":
                return f"({self.factor(base_and_index(node))})**({self.factor(inside[2])})"
            case "msqrt":
                return f"math.sqrt({self.row(node)})"
            case "mrow" if inside and inside[0].tag == "mi" and inside[0].text in FUNCTIONS:
                return f"f[{inside[0].text!r}]({self.factor(inside[-1])})"
            case "mrow" if inside and inside[0].get("fence"):
                within = ElementTree.Element("mrow")
                within.extend(inside[1:-1])
                comma = any(part.tag == "mo" and part.text == "," for part in inside)
                row = self.row(within)
                return f"abs({row})" if inside[0].text == "|" else row if comma else f"({row})"
            case "mrow":
                return f"({self.row(node)})"
        raise AssertionError(f"{ElementTree.tostring(node, 'unicode')}: no symbol among {list(self.values)}")


def symbols_in(line: str, symbols: Iterable[str]) -> tuple[set[str], set[str]]:
    """Which of these symbols a line has, and the text of what is no symbol among them, number or constant."""
    known = {symbol_key(symbol): symbol for symbol in symbols}
    present: set[str] = set()
    unknown: set[str] = set()

    def read(node: ElementTree.Element) -> None:
        if key(node) in known:
            present.add(known[key(node)])
        elif node.tag == "msubsup":
            read(base_and_index(node))
            read(node[2])
        elif node.tag == "msub" or (node.tag == "mi" and node.text not in CONSTANTS) or node.tag == "mover":
            unknown.add("".join(node.itertext()))
        else:
            for part in node:
                read(part)

    left, _, right = line.partition(" = ")
    if left in known.values():  # of two letters, as ΔE
        present.add(left)
        read(tree(right))
    else:
        read(tree(line))
    return present, unknown
