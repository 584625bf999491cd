"""MathML of equations that are written as a line of text, as ``κ = κ_p/(1 - R_r κ_p)``.

Neighbouring factors are a product, ``/`` divides the product on its left by the factor on its right, ``_`` and ``^`` apply to one name,
number or bracket, accents, primes and a star belong to their letter, and a function applies to the factor on its right.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from html import escape
from types import MappingProxyType
from typing import NamedTuple

ACCENTS: Mapping[str, str] = MappingProxyType(
    {"\u0307": "˙", "\u0308": "¨", "\u20db": "⃛", "\u0304": "¯", "\u0302": "^", "\u20d7": "→"}
)
PRIMES = "′″‴"
RAISED: Mapping[str, str] = MappingProxyType(dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿ", "0123456789-+n", strict=True)))
LOWERED: Mapping[str, str] = MappingProxyType(dict(zip("₀₁₂₃₄₅₆₇₈₉₋₊ₙᵢⱼ", "0123456789-+nij", strict=True)))
FUNCTIONS = (
    "arcsin",
    "arccos",
    "arctan",
    "atan2",
    "arg",
    "sin",
    "cos",
    "tan",
    "sgn",
    "max",
    "min",
    "Im",
    "Re",
    "det",
    "ln",
)
BIG = "∫Σ"
THIN_SPACE = '<mspace width="0.167em"/>'
CLOSING: Mapping[str, str] = MappingProxyType({"(": ")", "[": "]", "{": "}", "|": "|"})
_FUNCTION = re.compile("|".join(FUNCTIONS))


class _Node(NamedTuple):
    """MathML of a factor; of a bracket also the MathML of its content."""

    xml: str
    content: str | None = None
    is_function: bool = False  # it is separated from the factor on its left

    @property
    def bare(self) -> str:
        """MathML without its bracket, as in a fraction or an index."""
        return f"<mrow>{self.content}</mrow>" if self.content is not None else self.xml


class _Reader:
    def __init__(self, line: str) -> None:
        # a letter with an accent becomes a letter and an accent; indices do not change
        self.text = "".join(unicodedata.normalize("NFD", c) for c in line.replace("-", "−"))
        self.at = 0

    @property
    def next(self) -> str:
        return self.text[self.at] if self.at < len(self.text) else ""

    def spaces(self) -> None:
        while self.next == " ":
            self.at += 1

    def take(self) -> str:
        self.at += 1
        return self.text[self.at - 1]

    def row(self, closing: str = "") -> str:
        """A row up to the closing bracket, which is read too, or to the end."""
        parts: list[str] = []
        product: list[_Node] = []
        while True:
            self.spaces()
            sign = self.next
            if not sign or sign == closing:
                if sign != closing:
                    raise ValueError(f"{self.text!r}: {closing!r} is missing")
                self.at += len(closing)
                break
            if sign == "/":
                self.take()
                self.spaces()
                above = (
                    product[0].bare if len(product) == 1 else f"<mrow>{''.join(node.xml for node in product)}</mrow>"
                )
                product = [_Node(f"<mfrac>{above}{self.factor().bare}</mfrac>")]
            elif sign.isalnum() or sign in "∂∞√" or sign in CLOSING or sign in BIG:
                node = self.factor()
                if sign in BIG:  # of what follows, not a factor of it
                    parts += [*(factor.xml for factor in product), node.xml]
                    product = []
                else:
                    product.append(_Node(THIN_SPACE + node.xml) if node.is_function and product else node)
            elif sign in ")]}" or unicodedata.category(sign).startswith("M"):
                raise ValueError(f"{self.text!r}: {sign!r} at {self.at} has no letter on its left")
            else:
                parts += [*(factor.xml for factor in product), f"<mo>{escape(self.take(), quote=False)}</mo>"]
                product = []
        return "".join([*parts, *(factor.xml for factor in product)])

    def factor(self) -> _Node:
        """A name, number, bracket, root or function of a factor, with its indices and powers."""
        function = _FUNCTION.match(self.text, self.at)
        if function is not None and not self.text[function.end() : function.end() + 1].isalpha():
            self.at = function.end()
            name = self.scripts(_Node(f"<mi>{function[0]}</mi>"))
            self.spaces()
            argument = self.factor()
            space = "" if argument.content is not None else THIN_SPACE
            return _Node(f"<mrow>{name.xml}<mo>\u2061</mo>{space}{argument.xml}</mrow>", is_function=True)
        sign = self.next
        if sign == "√":
            self.take()
            return self.scripts(_Node(f"<msqrt>{self.factor().bare}</msqrt>"))
        if sign in "d∂" and self.text[self.at + 1 : self.at + 2].isalpha():  # of a differential
            self.take()
            return _Node(f"<mrow><mi>{sign}</mi>{self.factor().xml}</mrow>")
        return self.scripts(self.atom())

    def atom(self) -> _Node:
        sign = self.take()
        if sign in CLOSING:
            content = self.row(CLOSING[sign])
            fences = (f'<mo fence="true">{escape(fence, quote=False)}</mo>' for fence in (sign, CLOSING[sign]))
            opening, closing = fences
            return _Node(f"<mrow>{opening}{content}{closing}</mrow>", content if sign == "(" else None)
        if sign.isdigit() and sign not in RAISED and sign not in LOWERED:
            while self.next.isascii() and (
                self.next.isdigit() or (self.next == "." and self.text[self.at + 1 : self.at + 2].isdigit())
            ):
                sign += self.take()
            return _Node(f"<mn>{sign}</mn>")
        if sign in BIG:
            return _Node(f"<mo>{sign}</mo>")
        if not (sign.isalpha() or sign in "∂∞½¼"):
            raise ValueError(f"{self.text!r}: {sign!r} at {self.at - 1} is no name, number or bracket")
        xml = f"<mn>{sign}</mn>" if sign in "½¼" else f"<mi>{sign}</mi>"
        while self.next and self.next in ACCENTS:
            xml = f'<mover>{xml}<mo stretchy="false">{ACCENTS[self.take()]}</mo></mover>'
        return _Node(xml)

    def scripts(self, node: _Node) -> _Node:
        below, above = "", ""
        while self.next and (self.next in PRIMES or self.next in RAISED or self.next in LOWERED or self.next in "_^*"):
            sign = self.take()
            if sign in PRIMES:  # raised by its own shape
                node = _Node(f'<mrow>{node.xml}<mo lspace="0" rspace="0">{sign}</mo></mrow>')
            elif sign == "*":  # of a letter, as E*
                node = _Node(f"<msup>{node.xml}<mo>*</mo></msup>")
            elif sign in RAISED or sign in LOWERED:
                rows = RAISED if sign in RAISED else LOWERED
                digits = rows[sign]
                while self.next and self.next in rows:
                    digits += rows[self.take()]
                number = f"<mi>{digits}</mi>" if digits.isalpha() else f"<mn>{digits.replace('-', '−')}</mn>"
                above, below = (above + number, below) if sign in RAISED else (above, below + number)
            elif sign == "^":
                above += self.atom().bare
            else:
                below += self.index()
        if not (below or above):
            return node
        below, above = (f"<mrow>{script}</mrow>" if script else "" for script in (below, above))
        tag = "msubsup" if below and above else "msub" if below else "msup"
        return _Node(f"<{tag}>{node.xml}{below}{above}</{tag}>")

    def index(self) -> str:
        """An index: neighbouring letters and digits, or the content of a bracket."""
        if self.next == "(":
            return self.atom().bare
        text = ""
        while self.next.isalnum() and self.next not in RAISED and self.next not in LOWERED:
            text += self.take()
        return f"<mn>{text}</mn>" if text.isdigit() else f"<mi>{text}</mi>"


def mathml(line: str) -> str:
    """The line as a MathML element, with the line itself as its alternative text. Raises ValueError where it cannot be read."""
    row = _Reader(line).row()
    text = f'xmlns="http://www.w3.org/1998/Math/MathML" display="block" alttext="{escape(line)}"'
    return f"<math {text}><mrow>{row}</mrow></math>"
