"""Changes that lose digits, and such that compute what nobody asked for: right to first order, no sign is wrong, and yet a
test must notice; see mutations.py."""

BENCH = "tests/benchmarks/test_benchmarks.py::test_our_error_keeps_below_its_derived_bound"
READS = "tests/gui/test_reads.py::"
ALONE = READS + "test_each_view_alone_computes_its_stages_and_no_others"
EDIT = READS + "test_an_edit_recomputes_only_what_depends_on_it"
HIDDEN = READS + "test_what_cannot_be_seen_neither_computes_nor_draws"
LINKAGE, SHAFT = (f"tests/core/test_{name}.py::" for name in ("linkage", "shaft"))
STRESS = "tests/core/test_stress_cases.py::"

DIGIT_MUTATIONS: dict[str, list[tuple[str, str, str]]] = {
    # -- digits: what keeps them in each kernel, replaced by what a textbook has, or rounded on the way ----------------
    "core/laws/pieces.py": [
        ("angle = f * w + phase\n            sin", "angle = f * (w + 64.0) - f * 64.0 + phase\n            sin", BENCH + "[law-None]"),
    ],
    "core/blend/family.py": [
        ("works = [SPEEDS[name] * h for", "works = [SPEEDS[name] * h + 1024.0 - 1024.0 for", BENCH + "[blending-None]"),
    ],
    "core/linkage/triangle.py": [
        ("(small - gap) * (small + gap)", "(small * small - gap * gap)",
         LINKAGE + "test_area_and_angle_keep_their_digits_in_a_needle"),
    ],
    "core/linkage/dead_centres.py": [
        ("((self.root - far) + self.rest)", "(self.root - far)",
         LINKAGE + "test_the_area_keeps_all_its_digits_down_to_dead_centres"),
    ],
    "core/linkage/rod_and_arm.py": [
        ("np.add(square, difference, out", "np.add((square + 1024.0) - 1024.0, difference, out", BENCH + "[linkage-None]"),
    ],
    "core/mechanism/dyads.py": [
        ("between = 0.5 * (la * la + lb * lb - square)", "between = 0.5 * ((la * la + 64.0) + lb * lb - square) - 32.0",
         BENCH + "[dyads-None]"),
    ],
    "core/cam/shape.py": [
        ("np.arctan2(np.abs(cross(normal, train.travel)), np.abs(dot(normal, train.travel)))",
         "np.arccos(np.minimum(np.abs(dot(normal, train.travel)), 1.0))",
         STRESS + "test_a_pressure_angle_near_zero_keeps_its_digits[1e-06]"),
        ("normal = (-1j * sense) * t / np.abs(t)", "normal = ((-1j * sense) * t / np.abs(t) + 1024.0) - 1024.0", BENCH + "[profile-None]"),
        ("speed = np.abs(t)\n    cube", "speed = (np.abs(t) + 64.0) - 64.0\n    cube", BENCH + "[curvature-None]"),
    ],
    "core/dynamics/forces.py": [
        ("e = (cross(pin_b - centre, mass_force) - spin) / length",
         "e = ((cross(pin_b - centre, mass_force) - spin) / length + 2.0**26) - 2.0**26", BENCH + "[torque-None]"),
    ],
    "core/shaft.py": [
        ("power = to_powers @ (to_chebyshev @ values.reshape(-1, NODES).T)",
         "power = np.linalg.inv(np.vander(_nodes()[0], NODES, increasing=True)) @ values.reshape(-1, NODES).T",
         BENCH + "[flywheel-None]"),
    ],
    "core/stability/tongues.py": [
        ("if outer is not None:", "if False:", BENCH + "[tongues-1e-08]"),
    ],
    "core/stability/monodromy.py": [
        ("SWEEPS = 40", "SWEEPS = 6", BENCH + "[monodromy-None]"),
        ("4.0 * EPS * np.abs(v)", "1e-9 * np.abs(v)", BENCH + "[monodromy-None]"),
    ],
    "core/stability/turning.py": [
        ("SHARE = 0.25", "SHARE = 1e4", BENCH + "[wind-up-1e-13]"),
        ("ROUNDINGS = 2.0", "ROUNDINGS = 0.0 * (EPS := 2.0**-24)", BENCH + "[wind-up-1e-13]"),
    ],
    "core/stability/swing.py": [
        ("CLOSE = 1e-8", "CLOSE = 1.0", BENCH + "[wind-up-1e-13]"),
    ],
    # -- stages: one too many -------------------------------------------------------------------------------------------
    "kindyna_gui/reads.py": [('"motion": ("motion",)', '"motion": ("motion", "linkage")', READS + "test_the_table_is_what_the_views_say")],
    "kindyna_gui/plots_view.py": [("drawn, told = split(", "_ = study.dynamics\n        drawn, told = split(", ALONE)],
    "kindyna_gui/view.py": [("if self.on_screen():\n            if self.pause_ms", "if True:\n            if self.pause_ms", HIDDEN)],
    "core/study/stages.py": [("KEPT = 24", "KEPT = 1", EDIT)],
    "core/study/quantities.py": [
        ("if not study.levelled:", "if False:", SHAFT + "test_without_a_flywheel_nothing_of_it_is_computed_for_the_torque"),
        ("if study.levelled or not np.isfinite(torque).all():", "if True:",
         SHAFT + "test_without_a_flywheel_nothing_of_it_is_computed_for_the_torque"),
    ],
}  # fmt: skip
