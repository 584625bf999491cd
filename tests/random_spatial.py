"""Random designs with a cam in space, as files."""

from __future__ import annotations

import numpy as np

LAWS = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7", "mcv50", "simple-harmonic")


def random_design(rng: np.random.Generator) -> str:
    """Text of a design: sizes as a user may type them, most of them possible."""
    kind = rng.choice(("barrel", "globoidal"))
    turns = kind == "globoidal" or rng.random() < 0.6
    rollers = int(rng.choice((1, 2, 3, 4, 6, 8, 12))) if turns else 1
    form = "rib" if rng.random() < 0.5 and (rollers > 1 or not turns) else "groove"
    unit, pitch = ("deg", 360.0 / rollers) if turns else ("mm", 0.0)
    advance = pitch * int(rng.integers(1, 3)) if rollers > 1 and rng.random() < 0.8 else 0.0
    inner = float(10.0 ** rng.uniform(1.2, 2.3))
    lines = ["format = 1", 'name = "Random"', "[motion]", f"start_{unit} = {rng.uniform(-20.0, 40.0):.3f}"]
    if advance:
        lines.append(f"advance_{unit} = {advance!r}")
    rise = advance or float(rng.uniform(2.0, 60.0))
    cuts = np.sort(rng.choice(np.arange(20, 340, 10), size=3, replace=False))
    spans = np.diff(np.concatenate(([0.0], cuts, [360.0])))
    rises = (rise, 0.0, 0.0 if advance else -rise, 0.0)
    for span, height in zip(spans, rises, strict=True):
        law = rng.choice(LAWS) if height else "dwell"
        lines += ["[[motion.segments]]", f'law = "{law}"', f"span_deg = {span}"]
        lines += [f"rise_{unit} = {height!r}"] if height else []
    length = float(inner * rng.uniform(0.1, 0.6))
    radius = float(inner * 10.0 ** rng.uniform(-1.3, -0.2))
    lines += ["[cam]", f'kind = "{kind}"', f'form = "{form}"', f"rollers = {rollers}"]
    lines += [f"roller_radius_mm = {radius:.4f}", f"roller_length_mm = {length:.4f}", f"roller_inner_mm = {inner:.4f}"]
    if kind == "globoidal":
        lines.append(f"centre_distance_mm = {inner + length + radius * rng.uniform(0.8, 6.0):.4f}")
    elif turns:
        lines.append(f"arm_mm = {radius * rng.uniform(0.8, 3.0) * max(1, rollers) ** rng.uniform(0.5, 1.0):.4f}")
    if rng.random() < 0.4:
        lines.append(f"roller_taper_deg = {rng.uniform(-25.0, 25.0):.3f}")
    if form == "rib" and not turns:
        lines.append(f"roller_distance_mm = {radius * rng.uniform(1.9, 5.0):.4f}")
    if form == "groove" and rng.random() < 0.4:
        lines.append(f"play_mm = {radius * 10.0 ** rng.uniform(-4.0, -1.0):.5f}")
    if rng.random() < 0.5:
        lines.append(f"length_mm = {inner * rng.uniform(0.5, 3.0):.3f}")
    if kind == "barrel" and rng.random() < 0.5:
        lines.append(f"outer_radius_mm = {inner + length * rng.uniform(-0.1, 1.2):.3f}")
    if rng.random() < 0.3:
        lines.append(f"bore_mm = {inner * rng.uniform(0.1, 1.5):.3f}")
    sense, speed = rng.choice(("ccw", "cw")), rng.uniform(1.0, 600.0)
    lines += ["[shaft]", f'rotation = "{sense}"', f"speed_rpm = {speed:.3f}"]
    if rng.random() < 0.8:
        mass, force, friction = (
            ("inertia_kg_m2", "torque_nm", "friction_nm") if turns else ("mass_kg", "force_n", "friction_n")
        )
        lines += [
            "[loads]",
            f"{mass} = {10.0 ** rng.uniform(-3.0, 1.0):.5f}",
            f"{force} = {rng.uniform(-100.0, 100.0):.3f}",
        ]
        lines.append(f"{friction} = {rng.uniform(0.0, 20.0):.3f}")
    return "\n".join(lines) + "\n"
