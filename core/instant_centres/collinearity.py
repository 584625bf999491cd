"""The theorem of three centres as a proof of a table of centres: those of any three bodies lie on one line (Kennedy)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations

import numpy as np

from core.frozen import frozen
from core.instant_centres.centre import Centres, Key
from core.instant_centres.linkage import CentreTable, centres_in_motion, primary_pairs
from core.mechanism.kinematics import Kinematics

Triple = tuple[str, str, str]
PROVEN = 12  # bodies of which every centre is proven: as many as a table of them all can show


@frozen(eq=False)
class Collinearity:
    """For T triples of bodies at n positions.

    triples  (T,) names of bodies
    zero     (T, n) determinant of the three centres' coordinates, each a vector (point/size, weight) of length 1: 0 by
             the theorem
    error_bound    (T, n) how many times the rounding of the poses it carries; infinite where the three bodies do not move
             against each other, and the theorem says nothing
    """

    triples: tuple[Triple, ...]
    zero: np.ndarray
    error_bound: np.ndarray


def proving_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """Triples of b bodies that hold every centre, about b²/2 of the b³/6 there are.

    First the frame (the first body) with every two others: from λ_ab P_ab = λ_fb P_fb - λ_fa P_fa, λ the relative turning
    velocities, which these say, that of any other three follows by adding three of them. Then, for every two bodies, a third
    one that pins or guides join to both: the line through these two centres is known without velocities.
    """
    shown = {frozenset(key) for key in primary}
    neighbours = {name: {other for key in shown if name in key for other in key - {name}} for name in bodies}
    order = {name: i for i, name in enumerate(bodies)}
    frame, *others = bodies
    found = dict.fromkeys((frame, a, b) for a, b in combinations(others, 2))
    for a, b in combinations(bodies, 2):
        common = neighbours[a] & neighbours[b]
        if common:
            third = min(common, key=order.__getitem__)
            first, second, last = sorted((a, b, third), key=order.__getitem__)
            found[first, second, last] = None
    return tuple(found)


def joining_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """The frame with every two bodies that a pin or a guide joins, about b of them: each line through two centres on the frame holds the
    one that is seen. The centres of all other bodies follow from those on the frame, by the sums of ``proving_triples``."""
    frame = bodies[0]
    return tuple((frame, a, b) for a, b in primary if frame not in (a, b))


def collinearity(table: CentreTable) -> np.ndarray:
    """The largest determinant (n,) of the proving triples of a table of centres: 0 by Kennedy's theorem."""
    triples = proving_triples(table.bodies, table.primary)
    return np.asarray(_determinants(table.centres, triples, table.size).max(axis=0, initial=0.0))


def moving_collinearity(kinematics: Kinematics, size: float) -> Collinearity:
    """The proof at every position of a mechanism whose driver moves at unit speed; size [m] of the mechanism. Of more bodies than
    ``PROVEN`` that of the centres on the frame.

    A determinant carries the rounding of its worst centre, and no less than that of the largest relative velocity of the
    three bodies: three links pinned to each other in a triangle have pins to see, and no centres.
    """
    bodies = tuple(kinematics.bodies)
    order = {name: i for i, name in enumerate(bodies)}
    triples = (proving_triples if len(bodies) <= PROVEN else joining_triples)(bodies, primary_pairs(kinematics, order))
    wanted = dict.fromkeys(key for triple in triples for key in combinations(triple, 2))
    centres, motion, _ = centres_in_motion(kinematics, size, bodies, wanted)
    n = kinematics.theta.size
    rows = {key: np.broadcast_to(np.asarray(centre.error_bound, dtype=float), (n,)) for key, centre in centres.items()}
    with np.errstate(divide="ignore"):
        standstill = 1.0 / _of_keys({key: np.broadcast_to(m, (n,)) for key, m in motion.items()}, triples).max(axis=1)
    error_bound = np.maximum(_of_keys(rows, triples).max(axis=1), standstill)
    return Collinearity(triples, _determinants(centres, triples, size), error_bound)


def _of_keys(rows: Mapping[Key, np.ndarray], triples: tuple[Triple, ...]) -> np.ndarray:
    """Rows of the centres (a, b), (b, c), (a, c) of each triple (T, 3, ...)."""
    at = {key: i for i, key in enumerate(rows)}
    which = [(at[a, b], at[b, c], at[a, c]) for a, b, c in triples]
    return np.array(list(rows.values()))[np.array(which, dtype=int).reshape(-1, 3)]


def _determinants(centres: Mapping[Key, Centres], triples: tuple[Triple, ...], size: float) -> np.ndarray:
    """|h1 · (h2 × h3)| (T, n)."""
    points = _of_keys({key: centre.point / size for key, centre in centres.items()}, triples)
    weights = _of_keys({key: centre.weight for key, centre in centres.items()}, triples)
    (x1, x2, x3), (y1, y2, y3) = np.moveaxis(points.real, 1, 0), np.moveaxis(points.imag, 1, 0)
    w1, w2, w3 = np.moveaxis(weights, 1, 0)
    return np.asarray(np.abs(x1 * (y2 * w3 - y3 * w2) + y1 * (w2 * x3 - w3 * x2) + w1 * (x2 * y3 - x3 * y2)))
