"""Changes that lose digits, and such that compute what nobody asked for: right to first order, no sign is wrong, and yet a
test must notice; see mutations.py."""

BENCH = "tests/benchmarks/test_benchmarks.py::test_our_error_keeps_below_its_derived_bound"
READS = "tests/gui/test_reads.py::"
ALONE = READS + "test_each_view_alone_computes_its_stages_and_no_others"
EDIT = READS + "test_an_edit_recomputes_only_what_depends_on_it"
HIDDEN = READS + "test_what_cannot_be_seen_neither_computes_nor_draws"
LINKAGE, SHAFT = (f"tests/core/test_{name}.py::" for name in ("linkage", "shaft"))
STRESS = "tests/core/test_stress_cases.py::"
KEEPS = STRESS + "test_the_error_keeps_below_what_the_condition_allows"
DYADS = "tests/core/test_dyad_digits.py::test_angles_rates_and_joint_of_a_dyad_keep_their_digits"
ASKED = "tests/core/test_when_asked.py::"
EDITS = "tests/core/test_study_edits.py::"
BY_FIELD = EDITS + "test_a_fields_edit_computes_its_stages_again_and_going_back_none"
NAMED = EDITS + "test_another_name_computes_nothing"
LOADED = EDITS + "test_other_loads_leave_the_extremes_of_what_moves_as_they_are"
OF_LINKAGES = READS + "test_each_view_alone_computes_no_more_of_a_linkage"
SHAFT_DIGITS = "tests/core/test_stability_digits.py::"
BARE = SHAFT_DIGITS + "test_a_bare_shaft_turns_as_in_closed_form_at_any_speed"
TIMED = SHAFT_DIGITS + "test_in_time_and_by_the_cams_angle_the_wind_up_is_the_same"
FORCE = SHAFT_DIGITS + "test_the_contact_force_keeps_its_digits"
WINDUP = "tests/core/test_stability_windup.py::"

DIGIT_MUTATIONS: dict[str, list[tuple[str, str, str]]] = {
    # -- digits: what keeps them in each kernel, replaced by what a textbook has, or rounded on the way ----------------
    "core/laws/pieces.py": [
        ("angle = f * w + phase\n            sin", "angle = f * (w + 64.0) - f * 64.0 + phase\n            sin", BENCH + "[law-None]"),
    ],
    "core/blend/family.py": [
        ("works = [SPEEDS[curve] * h for", "works = [SPEEDS[curve] * h + 1024.0 - 1024.0 for", BENCH + "[blending-None]"),
        ("at[name] = value\n", "pass\n",
         "tests/core/test_blend_points.py::test_a_height_that_is_asked_for_is_answered_to_the_last_bit"),
    ],
    "core/blend/solver.py": [
        ("return value if met and", "return end.value if met and", "tests/core/test_making.py::test_from_outside_into_a_file"),
    ],
    "core/linkage/triangle.py": [
        ("(small - gap) * (small + gap)", "(small * small - gap * gap)",
         LINKAGE + "test_area_and_angle_keep_their_digits_in_a_needle"),
        ("stretched += more\n    folded -= less\n", "pass\n",
         LINKAGE + "test_area_and_angle_keep_their_digits_in_a_needle"),
    ],
    "core/linkage/dead_centres.py": [
        ("((self.root - far) + self.rest)", "(self.root - far)",
         LINKAGE + "test_the_area_keeps_all_its_digits_down_to_dead_centres"),
    ],
    "core/linkage/rod_and_arm.py": [
        ("np.multiply(square + other, share", "np.multiply((square + 1024.0) - 1024.0 + other, share", BENCH + "[linkage-None]"),
    ],
    "core/mechanism/dyads.py": [
        ("between = 0.5 * (la * la + lb * lb - square)", "between = 0.5 * ((la * la + 64.0) + lb * lb - square) - 32.0",
         BENCH + "[dyads-None]"),
        ("np.array([cross(along, known) * inverse,", "np.array([cross(along, known) * inverse + 256.0 - 256.0,",
         DYADS + "[rpr-1-1.0]"),
    ],
    "core/mechanism/closing.py": [
        ("inside = room * (long + np.abs(short))", "inside = long * long - short * short", KEEPS + "[Slide across its rod, 1e-07]"),
        ("-3.0 * w * angle[2], -(w * w * w)", "-3.0 * w * angle[2], (256.0 - w * w * w) - 256.0", DYADS + "[rpr-1-1.0]"),
    ],
    "core/cam/shape.py": [
        ("np.arctan2(np.abs(cross(normal, train.travel)), np.abs(dot(normal, train.travel)))",
         "np.arccos(np.minimum(np.abs(dot(normal, train.travel)), 1.0))",
         STRESS + "test_a_pressure_angle_near_zero_keeps_its_digits[1e-06]"),
        ("normal = (-1j * sense) * t / np.abs(t)", "normal = ((-1j * sense) * t / np.abs(t) + 1024.0) - 1024.0", BENCH + "[profile-None]"),
        ("speed = np.abs(motion[1])", "speed = (np.abs(motion[1]) + 64.0) - 64.0", BENCH + "[curvature-None]"),
        ("sense, reference, t, lambda: cam_follower_centre(", "sense, reference, t, cam_follower_centre(",
         ASKED + "test_a_stage_makes_what_it_reads_of_those_before_it_and_nothing_else"),
        ("bend = cache(lambda: curvature(motion, sense))", "bend = lambda: curvature(motion, sense)",
         ASKED + "test_the_curvatures_are_made_together_and_once"),
        ("        pitch_curvature=bend,", "        pitch_curvature=bend(),",
         ASKED + "test_a_stage_makes_what_it_reads_of_those_before_it_and_nothing_else"),
    ],
    "core/dynamics/forces.py": [
        ("e = (cross(pin_b - centre, mass_force) - spin) / length",
         "e = ((cross(pin_b - centre, mass_force) - spin) / length + 2.0**26) - 2.0**26", BENCH + "[torque-None]"),
    ],
    "core/dynamics/loading.py": [
        ("about = sum(p.about_centre + p.mass * abs(p.centre - centre) ** 2 for p in parts)",
         "about = sum(p.about_centre + p.mass * abs(p.centre) ** 2 for p in parts) - mass * abs(centre) ** 2",
         STRESS + "test_masses_far_from_the_pivot_and_near_each_other_keep_their_inertia"),
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
        ("omega * h < 1e-4", "omega * h < 1e-2", BARE + "[0.0]"),
        ("4.0 * EPS * np.abs(v)", "1e-9 * np.abs(v)", BENCH + "[monodromy-None]"),
    ],
    "core/stability/turning.py": [
        ("LEFT = 2.0", "LEFT = 66.0", WINDUP + "test_a_fast_shaft_in_a_slow_cam_tells_its_error_closely"),
        ("SHARE = 0.25", "SHARE = 1e4", BENCH + "[wind-up-1e-13]"),
        ("ROUNDINGS = 2.0", "ROUNDINGS = 0.0 * (EPS := 2.0**-24)", BENCH + "[wind-up-1e-13]"),
    ],
    "core/stability/march.py": [
        ("SETTLED = 32.0 * EPS", "SETTLED = 1e-8", TIMED),
        ("STAGES = 12", "STAGES = 7", TIMED),
        ("(here[:, 1] - there[:, 1]) / speed", "(1.0 + 1e-9) * (here[:, 1] - there[:, 1]) / speed",
         SHAFT_DIGITS + "test_derivatives_through_jumps_of_the_inertia_keep_eleven_digits"),
    ],
    "core/stability/contact.py": [
        ("values[1] * speed * speed", "values[1] * (speed * speed).astype(np.float32)", FORCE),
    ],
    "core/stability/windup.py": [
        ("TURN) - OUTSIDE", "TURN)", FORCE),
    ],
    "core/stability/looks.py": [
        ("CLOSE = 1e-7", "CLOSE = 1.0", SHAFT_DIGITS + "test_what_looks_see_is_what_the_history_says"),
    ],
    "core/stability/means.py": [
        ("(swing.omega + swing.decay) * wrong", "wrong",
         "tests/core/test_stability_figures.py::test_means_tell_what_they_may_be_wrong_by"),
    ],
    "core/stability/swing.py": [
        ("CLOSE = 1e-8", "CLOSE = 1.0", BENCH + "[wind-up-1e-13]"),
    ],
    # -- stages: one too many -------------------------------------------------------------------------------------------
    "kindyna_gui/reads.py": [('"motion": ("motion",)', '"motion": ("motion", "linkage")', READS + "test_the_table_is_what_the_views_say")],
    "kindyna_gui/plots_view.py": [("drawn, told = split(", "_ = study.dynamics\n        drawn, told = split(", ALONE)],
    "kindyna_gui/view.py": [
        ("if self.on_screen():\n            if self.pause_ms", "if True:\n            if self.pause_ms", HIDDEN),
        ("not self.in_trouble and self.on_screen():", "not self.in_trouble:",
         READS + "test_who_cannot_be_seen_does_not_follow_the_cam_though_nothing_else_is_new"),
        ("return not rect.isEmpty()", "return True", READS + "test_a_dock_behind_another_neither_computes_nor_paints"),
    ],
    "kindyna_gui/centres_view.py": [("self.now = position(", "_ = study.dynamics\n        self.now = position(", OF_LINKAGES)],
    "kindyna_gui/session.py": [
        ("if self._at is None or self._at[0] != theta:", "if True:",
         READS + "test_one_step_of_the_cam_is_computed_once_for_all_that_follow_it"),
    ],
    "kindyna_gui/pictures/items.py": [
        ("UNSEEN / wanted", "8.0 * UNSEEN / wanted", "tests/gui/test_detail.py::test_no_point_of_the_cam_is_off_by_more_than_nobody_sees"),
    ],
    "kindyna_gui/pictures/plot_lines.py": [
        ("if wanted == self._laid:", "if False:", "tests/gui/test_detail.py::test_a_curve_is_thinned_once_for_a_size_and_a_design"),
    ],
    "core/study/stages.py": [("KEPT = 24", "KEPT = 1", EDIT)],
    "core/study/linkage.py": [
        ("replace(linkage.driver, speed_rpm=1.0)", "replace(linkage.driver)", BY_FIELD),
        ("part and replace(part, roller_radius_mm=1.0)", "part", BY_FIELD),
        ("return design.linkage, design.motion, design.cam", "return design.name, design.linkage, design.motion, design.cam", NAMED),
        ('loads = design.loads if stage == "dynamics" else None', "loads = design.loads", LOADED),
    ],
    "core/study/quantities.py": [
        ("if not study.levelled:", "if False:", SHAFT + "test_without_a_flywheel_nothing_of_it_is_computed_for_the_torque"),
        ("if study.levelled or not np.isfinite(torque).all():", "if True:",
         SHAFT + "test_without_a_flywheel_nothing_of_it_is_computed_for_the_torque"),
    ],
}  # fmt: skip
