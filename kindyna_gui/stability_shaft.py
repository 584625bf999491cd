"""A flexible shaft for a design that has none."""

from __future__ import annotations

from dataclasses import fields

from core.design import SingleCam, with_assumed, with_elastic
from core.errors import NoStability
from core.stability import first_guess
from core.study import Study


def flexible(study: Study) -> SingleCam:
    """The design with a first guess of its shaft's elasticity, marked as assumed. Raises NoAnswer where there is no
    linkage, NoStability where nothing is moved."""
    guess = first_guess(study.linkage, study.loading, study.omega)
    if guess is None:
        raise NoStability("nothing is moved that could twist the shaft", "loads", "give masses")
    design = with_elastic(study.design, guess)
    for field in fields(guess)[:2]:  # inertia and stiffness; the rest is no figure of the machine
        design = with_assumed(design, f"shaft.{field.name}", True)
    return design
