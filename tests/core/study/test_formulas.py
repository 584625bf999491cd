"""Rows of FORMULAS: their text gives the quantity, their symbols are rows of LETTERS, and what computes them names them."""

import importlib
import math
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from zlib import crc32

import numpy as np
import pytest
from outlined import example, outline
from random_linkages import DRIVES, random_linkage
from sampled import spread
from typeset_lines import Evaluator, symbols_in

from core.design import Design, put
from core.output.channels import channels, existing
from core.output.explain import explainable, explained
from core.output.explain.shaft import FIGURES
from core.output.explain.workings import CALCULATIONS, calculation_of
from core.project import load, loads
from core.study import QUANTITIES, Study, names_of
from core.study.formulas import FORMULAS
from core.study.letters import LETTERS, keys_of
from core.study.quantities import OF_MEMBERS, shape_of
from core.study.study import variant_of
from core.study.symbols import Letter, symbol_of
from core.units import UNITS

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = [path.stem for path in sorted(EXAMPLES.glob("*.toml"))]
OF_ONE_DRIVE = [name for name in NAMES if "[[drives]]" not in (EXAMPLES / f"{name}.toml").read_text("utf-8")]
FACTORS = {unit.symbol: unit.factor for unit in UNITS.values()} | {"": 1.0}

NOT_EVALUATED = {
    "a vector between the motion and the profile, which no column holds": {"loop_closure.arm", "loop_closure.guide", "tangency"},
    "a balance with a sum over the loads, which the certificate proves": {
        "momentum_balance.slider", "momentum_balance.friction", "momentum_balance.rod", "momentum_balance.slider_arm",
        "momentum_balance.arm", "momentum_balance.guide", "power_balance", "power_balance.springs",
    },
    "a differential equation": {"verdicts.exact", "verdicts.approximation"},
    "an eigenvalue problem": {"bands.retuned", "bands.fixed", "bands.damped"},
    "an integral over the turn": {"balancer_torque_nm"},
    "made of the greatest slope over the turn": {"q"},
}  # fmt: skip
"""Reason -> rows that have no value to be evaluated at one angle."""

AXIS = """
format = 1
name = "Axis"
[motion]
start_{unit} = 0.0
{advance}
[[motion.segments]]
law = "modified-sine"
span_deg = 180.0
rise_{unit} = 60.0
[[motion.segments]]
law = "modified-sine"
span_deg = 180.0
rise_{unit} = {back}
[shaft]
rotation = "ccw"
speed_rpm = 60.0
[loads]
{loads}
[servo]
efficiency = 0.9
{servo}
"""


def axis(unit: str, load: str, servo: str, advance: float = 0.0) -> Design:
    text = "" if not advance else f"advance_{unit} = {advance}"
    return loads(AXIS.format(unit=unit, advance=text, back=advance - 60.0, loads=load, servo=servo))


@cache
def more_designs() -> Mapping[str, Design]:
    """Designs with what no example has."""
    stressed = load(EXAMPLES / "conjugate.toml")
    for prefix in ("cam.", "cam.second."):
        for name, value in (("material", "16mncr5"), ("roller_material", "16mncr5"), ("roller_load_rating_n", 20000.0)):
            stressed = put(stressed, prefix + name, value)
    elastic = load(EXAMPLES / "tappet_knife.toml")
    for name, value in (("follower_stiffness_n_per_mm", 2000.0), ("follower_damping_ratio", 0.1)):
        elastic = put(elastic, f"loads.{name}", value)
    rotary = 'kind = "rotary"\nfriction_nm = 2.0\ngear_ratio = 3.0\nrotor_inertia_kg_m2 = 0.0001\n'
    return {
        "stressed": stressed,
        "elastic": elastic,
        "slide": axis("mm", "mass_kg = 5.0\nforce_n = 10.0", f"{rotary}travel_mm_per_turn = 20.0\n", 120.0),
        "linear": axis("mm", "mass_kg = 5.0\nforce_n = 10.0", 'kind = "linear"\nfriction_n = 2.0\nmass_kg = 3.0\n'),
        "outlined": loads(
            example("four_bar") + outline("link 2", round_mm=5.0) + outline("frame", points=[[0.0, 80.0]], round_mm=3.0)
        ),
        "table": axis("deg", "inertia_kg_m2 = 0.2\ntorque_nm = 3.0", rotary),
        **{f"linkage {seed}": random_linkage(seed, DRIVES[seed]) for seed in (2, 5, 6)},
    }


def design(name: str) -> Design:
    return more_designs()[name] if name in more_designs() else load(EXAMPLES / f"{name}.toml")


def angles_of(study: Study, name: str) -> list[float]:
    """Two seeded angles [deg] at which the design has a position."""
    random = np.random.default_rng(crc32(name.encode()))
    if study.angle_degrees.size == study.samples:
        return [float(angle) for angle in random.uniform(0.0, 360.0, 2)]
    inside = study.angle_degrees[1:-1]
    return [float(angle) for angle in random.choice(inside, 2)]


def check(line: str, letters: tuple[Letter, ...], value: float, size: float, wraps: bool) -> None:
    """The line gives the value; size: of the quantity over the turn; all in SI units."""
    values = {letter.symbol: letter.value * FACTORS[letter.unit] for letter in letters}
    result = Evaluator(values).value(line)
    if wraps:
        result += 2.0 * math.pi * round((value - result) / (2.0 * math.pi))
    greatest = max(map(abs, values.values()), default=0.0)
    assert result == pytest.approx(value, rel=1e-9, abs=1e-9 * size + 1e-14 * greatest + 1e-12), line


# -- the text gives the quantity --------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*spread(OF_ONE_DRIVE, 3), "stressed", "elastic", "slide", "linear",
                                  "outlined", "table", "linkage 2", "linkage 5", "linkage 6"])  # fmt: skip
def test_the_text_of_a_formula_gives_its_quantity_at_seeded_angles(name: str) -> None:
    study = Study(design(name), 72)
    rows = existing(study, channels(study.design))
    sizes = {}
    for row in rows:
        values = np.abs(row.values(study))
        sizes[row.name] = float(values[np.isfinite(values)].max(initial=0.0)) * row.unit.factor
    for angle in angles_of(study, name):
        there = study.at_theta(np.array([math.radians(angle)]))
        for row in rows:
            value = float(row.values(there)[0]) * row.unit.factor
            calculation = calculation_of(there, row)
            if math.isfinite(value):
                assert calculation.letters, row.name
                check(calculation.lines[0], calculation.letters, value, sizes[row.name], row.unit.symbol == "°")


@pytest.mark.parametrize("name", ["transfer_lift", "kim_1990", "transfer_unit", "stressed"])
def test_the_text_of_a_formula_gives_its_figure_of_the_turn(name: str) -> None:
    study = Study(design(name), 72)
    figures = [figure for figure in FIGURES if figure in explainable(study)]
    assert figures
    for figure in figures:
        result = explained(study, figure)
        value = result.value * FACTORS[result.unit]
        check(result.lines[0], result.letters, value, abs(value), wraps=False)


def test_every_formula_is_evaluated_in_some_design_or_listed_with_its_reason() -> None:
    evaluated = {"torque_nm"}  # by the columns of a shaft, in test_explain
    for name in (*NAMES, *more_designs()):
        study = Study(design(name), 72)
        for single in study.solved_drives.values():
            names = names_of(single.design)
            evaluated |= {shape_of(quantity) for quantity in names}
            if variant := variant_of(names):
                evaluated |= {row for row in FORMULAS if row.endswith(variant)}
        evaluated |= set(explainable(study))
    listed = set().union(*NOT_EVALUATED.values())
    assert set(FORMULAS) - evaluated - listed == set()
    assert evaluated & listed == set() or listed <= set(FORMULAS)
    shown = {row.name for row in QUANTITIES.values() if row.slug} | {
        r.name for rows in OF_MEMBERS.values() for r in rows
    }
    assert shown <= set(FORMULAS), "every quantity that a reader sees has a formula"


# -- symbols ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FORMULAS)
def test_every_symbol_of_a_formula_is_a_row_of_letters_and_every_row_that_it_lists_occurs(name: str) -> None:
    formula = FORMULAS[name]
    listed = {symbol_of(key): key for key in formula.letters.split()}
    assert set(listed.values()) <= LETTERS.keys()
    present: set[str] = set()
    for line in formula.lines:
        there, unknown = symbols_in(line, listed)
        assert unknown == set(), line
        present |= there
    assert present == set(listed)
    if formula.values or name not in {"torque_nm", *CALCULATIONS, *set().union(*NOT_EVALUATED.values())}:
        keys = keys_of(formula)
        right = formula.evaluated.partition(" = ")[2]
        assert symbols_in(f"0 = {right}", [symbol_of(key) for key in keys]) == ({symbol_of(key) for key in keys}, set())
        assert all(LETTERS[key].value for key in keys)


def test_every_row_of_letters_occurs_in_a_formula() -> None:
    used = {key for row in FORMULAS.values() for key in f"{row.letters} {row.values}".split()}
    components = {key for key in used if re.search(r"[xy](\.|$)", key)}
    vectors = {re.sub(r"_?[xy](?=\.|$)", "", key) for key in components}
    assert set(LETTERS) - used - vectors - {f"{vector}_{axis}" for vector in used for axis in "xy"} <= {
        key for key in LETTERS if re.search(r"_[0-9]?[xy](\.|$)|′_[xy]$", key)
    }
    assert all(row.meaning for row in LETTERS.values())


# -- what computes it -------------------------------------------------------------------------------------


def docstrings(dotted: str) -> Iterator[str]:
    """Docstrings of a function or attribute and, of an attribute, of its class."""
    parts = dotted.split(".")
    for count in range(len(parts), 0, -1):
        try:
            owner = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        yield "" if count == 1 else owner.__doc__ or ""
        for name in parts[count:]:
            owner = getattr(owner, name)
            yield getattr(owner, "__doc__", "") or ""
        return


def named(source: str, text: str) -> bool:
    """Whether a text names a source: its author and first number, or its words."""
    paper = re.match(r"([A-Z][a-z]+)\d{4}\s*(\(\d+\)|§\d|Figs?\. \d+)?", source)
    if paper is None:
        return source.partition(",")[0].lower() in text.lower()
    return paper[1] in text and (paper[2] or "").strip("()") in text


@pytest.mark.parametrize("name", FORMULAS)
def test_the_docstring_of_what_computes_a_formula_has_its_line_or_its_source(name: str) -> None:
    formula = FORMULAS[name]
    texts = [" ".join(text.split()) for text in docstrings(f"core.{formula.function}")]
    text = texts[-1] if len(texts) > 1 else ""
    assert formula.lines[0] in text or any(named(source, text) for source in formula.source.split("; ")), (
        f"{formula.function}: {formula.lines[0]}, or {formula.source}"
    )
