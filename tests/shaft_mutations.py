"""Changes of ``core.stability`` that a test must notice; see mutations.py."""

COEFFICIENTS, FOURIER, TONGUES, MONODROMY, WINDUP, SPEEDS = (
    f"tests/core/test_stability_{name}.py::" for name in ("coefficients", "fourier", "tongues", "monodromy", "windup", "speeds")
)
FIGURES, CLI = "tests/core/test_stability_figures.py::", "tests/core/test_stability_cli.py::"
KIM = "tests/validation/test_kim_1990.py::"

BODIES = COEFFICIENTS + "test_inertia_and_load_of_a_train_are_those_of_its_bodies[c-2.5]"
SINGLE = COEFFICIENTS + "test_a_translating_mass_is_kims_single_mass"
RATES = COEFFICIENTS + "test_rows_are_each_others_derivatives_and_have_the_right_size[layout c]"
SPRING = COEFFICIENTS + "test_a_fixed_spring_as_stiff_as_kims_is_kims_at_its_own_speed"
CONTACT = COEFFICIENTS + "test_kims_contact_force_is_spring_and_mass"
EVEN = COEFFICIENTS + "test_the_contact_force_of_an_even_turn_is_that_of_the_dynamics[c]"
STEEP = COEFFICIENTS + "test_a_function_that_is_steep_gets_short_panels"
PSI = FOURIER + "test_psi_in_closed_form"
MATRIX = FOURIER + "test_multiplying_is_a_matrix"
DROPS = FOURIER + "test_22_leaves_out_inertia_and_centripetal_terms"
EDGES = KIM + "test_tongue_edges_are_the_reference_to_ten_decimals"
BOTH = TONGUES + "test_harmonic_balance_and_monodromy_agree_within_their_stated_errors"
OUTER = TONGUES + "test_what_the_outer_harmonics_do_is_worth_many_of_them"
NARROW = TONGUES + "test_tongues_a_millionth_wide_keep_both_edges[1]"
DIGITS = TONGUES + "test_orders_beyond_fifty_lose_no_digit[exact_21]"
STATED = TONGUES + "test_more_harmonics_bring_the_stated_error_down_and_it_stays_above_the_true_one"
DAMPED = KIM + "test_a_hundredth_of_damping_narrows_the_first_tongue"
COMPANION = TONGUES + "test_damped_edges_are_those_of_the_quadratic_eigenvalue_problem[0.01]"
TURN = MONODROMY + "test_one_turn_is_that_of_thirty_digits"
SLOPE = MONODROMY + "test_the_slope_is_the_derivative_by_eta[kim]"
LIOUVILLE = MONODROMY + "test_the_determinant_is_liouvilles[kim]"
OTHER = WINDUP + "test_the_wind_up_is_that_of_another_integrator"
DIFFERENCES = WINDUP + "test_the_derivatives_of_a_turn_are_differences_of_turns"
OWN = WINDUP + "test_the_contact_force_is_that_of_the_followers_own_motion"
BANDS = SPEEDS + "test_bands_are_tongues_as_speeds_with_their_largest_growth[kim]"
CLEAR = SPEEDS + "test_the_stiffness_that_is_told_keeps_clear_and_what_is_forbidden_grows"
LEAVES = KIM + "test_the_follower_leaves_the_cam_where_another_integrator_says"
REPEATS = WINDUP + "test_a_steady_response_repeats_and_its_matrix_is_its_stability"
LIMITS = SPEEDS + "test_the_own_speed_among_the_bands_is_told"
CLAIMS = KIM + "test_one_command_prints_the_papers_claims_against_ours"
SAMPLES = WINDUP + "test_the_averages_are_those_of_many_samples"
LOOKS = "tests/core/test_stability_digits.py::test_what_looks_see_is_what_the_history_says"
EACH = FIGURES + "test_means_are_those_of_each_history"
DASHED = FIGURES + "test_means_are_solid_where_contact_is_kept_and_dashed_where_it_is_lost"
REACHED = FIGURES + "test_the_certificate_and_the_report_say_what_error_was_reached"
ELEVEN = KIM + "test_the_eleven_by_eleven_matrix_is_the_papers"

MUTATIONS: dict[str, list[tuple[str, str, str]]] = {
    "core/stability/coefficients.py": [
        ("(z1 * z1.conjugate()).real + i * a1 * a1", "(z1 * z1.conjugate()).real - i * a1 * a1", BODIES),
        ("(z1.conjugate() * z2).real + i * a1 * a2", "(z1.conjugate() * z2).real - i * a1 * a2", BODIES),
        ("(z1.conjugate() * z3).real) +", "(z1.conjugate() * z2).real) +", BODIES),
        ("i * (a2 * a2 + a1 * a3)", "i * (a2 * a2 - a1 * a3)", BODIES),
        ("loading.rate * y1 * y1 - force * y2", "loading.rate * y1 * y1 + force * y2", BODIES),
        ("np.array([-force * y1, loading.rate", "np.array([-force * y1, -loading.rate", BODIES),
        ("out -= part.mass", "out += part.mass", BODIES),
        ("d, 0.5 * d1, u[0], 0.5 * d2", "d, d1, u[0], 0.5 * d2", RATES),
        ("d, 0.5 * d1, u[0], 0.5 * d2", "d, 0.5 * d1, u[0], d2", RATES),
        ("/ (stiffness * q)", "/ stiffness", SPRING),
        ("y[1] * y[1] + x * y[2]", "y[1] * y[1] - x * y[2]", SINGLE),
        ("x = y[0] - size.lowest", "x = y[0]", COEFFICIENTS + "test_neither_the_size_nor_the_place_of_the_stroke_matters"),
    ],
    "core/stability/contact.py": [
        ("np.zeros_like(rows[1]), rows[1], np.zeros_like(rows[1])", "np.zeros_like(rows[1]), rows[2], np.zeros_like(rows[1])",
         CONTACT),
        ("force=rate * sizes.lowest, rate=rate", "force=rate * sizes.lowest, rate=-rate", CONTACT),
        ("unit * q * stiffness / sizes.inertia", "unit * stiffness / sizes.inertia", EVEN),
        ("values[1] * speed * speed +", "values[1] * speed +", OWN),
        ("way_of[panels.piece] != 0.0", "way_of[panels.piece] == 0.0", CONTACT),
    ],
    "core/stability/panels.py": [
        ("worst <= TAIL", "worst <= 1e-3", STEEP),
        ("(values @ to_legendre(n).T) @ _legendre_to_powers(n).T", "values @ (to_legendre(n).T @ _legendre_to_powers(n).T)", CONTACT),
    ],
    "core/stability/fourier.py": [
        ("((-1j) ** degree)", "((1j) ** degree)", PSI),
        ("np.exp(-1j * k", "np.exp(1j * k", PSI),
    ],
    "core/stability/harmonics.py": [
        ("np.where(sine[:, None] | other, -1.0, 1.0)", "np.where(sine[:, None] & other, -1.0, 1.0)", MATRIX + "[False]"),
        ("np.sign(j - i), -np.sign(j - i))", "-np.sign(j - i), np.sign(j - i))", MATRIX + "[True]"),
        ("np.where(mixed, across, 1.0)", "1.0", MATRIX + "[False]"),
        ("np.where(i == 0.0, half_root, 1.0) * ", "1.0 * ", MATRIX + "[False]"),
    ],
    "core/stability/equations.py": [
        ("(1.0 + pull) / d, speed", "(1.0 - pull) / d, speed", BOTH + "[fixed-exact_21]"),
        ("pull / d + speed", "pull / d - speed", EDGES + "[exact_21]"),
        ("pull / d + speed", "pull + speed", EDGES + "[exact_21]"),
        ("np.ones_like(pull), np.zeros_like(pull), pull", "np.ones_like(pull), pull, pull", DROPS),
    ],
    "core/stability/tongues.py": [
        ("pencil = sigma * tw - tp", "pencil = sigma * tw + tp", EDGES + "[approx_22]"),
        ("square = 1.0 / mu - shift", "square = 1.0 / mu + shift", EDGES + "[approx_22]"),
        ("corrected[:, 0] -= own[:, 0]", "corrected[:, 0] += own[:, 0]",
         TONGUES + "test_near_eta_zero_edges_stay_real_and_the_bottom_is_told"),
        ("square[:, first] - own[:, first]", "square[:, first] + own[:, first]", OUTER),
        ("residual = by_p + square[:, None, :] * by_w", "residual = by_p - square[:, None, :] * by_w", OUTER),
        ("change * pull / stiff.min(axis=1) +", "0.0 * change +", STATED),
    ],
    "core/stability/monodromy.py": [
        ("p0 - lanes * shift", "p0 + lanes * shift", TURN + "[point1-exact_21]"),
        ("p0_slope - shift, (4.0", "p0_slope + shift, (4.0", SLOPE),
        ("c + a * s, s, -square * s, c - a * s), axis=-1", "c - a * s, s, -square * s, c + a * s), axis=-1", TURN + "[point1-exact_21]"),
        ("- (da * h)[..., None, None] * maps", "+ (da * h)[..., None, None] * maps", SLOPE),
        ("new += p1 * speed", "new -= p1 * speed", TURN + "[point1-approx_22]"),
        ("lost = lost + (p1", "lost = lost - (p1", LIOUVILLE),
        ("return first, first @ inner", "return first, inner @ first", SLOPE),
        ("db @ a + b @ da", "db @ a - b @ da", SLOPE),
        ("inner[..., 1, j] = -(weight", "inner[..., 1, j] = (weight", SLOPE),
        ("0.5 * np.log(det))", "np.log(det))", MONODROMY + "test_growth_is_that_of_the_larger_multiplier"),
    ],
    "core/stability/edges.py": [
        ("e[:, 0, 0] * k[:, 1, 1] - e[:, 0, 1]", "e[:, 0, 0] * k[:, 1, 1] + e[:, 0, 1]", BOTH + "[kim-exact_21]"),
        ("middle * middle - determinant(e) / square", "middle * middle + determinant(e) / square", BOTH + "[kim-exact_21]"),
        ("np.arange(count) % 2 == 0, -1.0, 1.0", "np.arange(count) % 2 == 0, 1.0, -1.0", BOTH + "[kim-exact_21]"),
        ("half > NARROW * damping", "half > 5.0 * damping", COMPANION),
    ],
    "core/stability/nonlinear.py": [
        ("* c * speed * speed - self._load", "* c * speed * speed + self._load", DIFFERENCES + "[0.0-kim]"),
        ("self._load[lane, None] * u + self.stiff", "self._load[lane, None] * u - self.stiff", DIFFERENCES + "[0.0-kim]"),
        ("force + self.damp[lane, None] * out[..., 0]", "force - self.damp[lane, None] * out[..., 0]", DIFFERENCES + "[0.05-kim]"),
        ("speed * speed + self.load", "speed * speed - self.load", OTHER + "[0.85-0.1-0.0-6.0]"),
        ("+ self.heavy * (self.drag", "- self.heavy * (self.drag", OTHER + "[0.85-0.1-0.0-6.0]"),
        ("self.drag * rate + self", "self.drag * rate - self", OTHER + "[0.85-0.1-0.0-6.0]"),
        ("(self.drag * rate", "(-self.drag * rate", OTHER + "[1.3-0.3-0.03-4.0]"),
        ("by_theta = -2.0 * q", "by_theta = 2.0 * q", DIFFERENCES + "[0.0-kim]"),
        ("k * speed * speed + 2.0 * c", "k * speed * speed - 2.0 * c", DIFFERENCES + "[0.0-kim]"),
        ("- load * u1 - damp * by_theta", "+ load * u1 - damp * by_theta", DIFFERENCES + "[0.0-kim]"),
        ("- load * u1 - damp * by_theta", "- load * u1 + damp * by_theta", DIFFERENCES + "[0.05-kim]"),
        ("out[..., 1, 2] -= 2.0 * TURN", "out[..., 1, 2] += 2.0 * TURN", DIFFERENCES + "[0.0-layout c]"),
        ("2.0 * TURN * self.damping * (1.0 - speed)", "2.0 * TURN * self.damping * (1.0 + speed)", DIFFERENCES + "[0.05-kim]"),
    ],
    "core/stability/march.py": [
        ("(here[:, 1] - there[:, 1]) / speed", "(there[:, 1] - here[:, 1]) / speed", DIFFERENCES + "[0.0-parabolic]"),
        ("left = outside.any(axis=1)", "left = outside.all(axis=1)", OTHER + "[0.9-0.4-0.0-3.0]"),
        ("(old + way) // count", "(old - way) // count", OTHER + "[2.0-0.05-0.0-12.0]"),
        ("right[..., 2] += by_eta", "right[..., 2] -= by_eta", DIFFERENCES + "[0.0-kim]"),
    ],
    "core/stability/swing.py": [
        ("rate + (self.decay + 1j", "rate + (1j", WINDUP + "test_a_history_goes_on_from_any_of_its_states[0.03]"),
        ("pointer.real - self.decay * beta", "pointer.real + self.decay * beta", OTHER + "[1.3-0.3-0.03-4.0]"),
        ("by_cam * (pointer.imag", "by_cam * (-pointer.imag", OTHER + "[0.85-0.1-0.0-6.0]"),
    ],
    "core/stability/turning.py": [
        ("(gone + beta - turn)", "(gone - beta - turn)", OTHER + "[0.85-0.1-0.0-6.0]"),
        ("found.settled & same", "found.settled", WINDUP + "test_a_cam_that_stands_thrice_at_an_angle_is_followed_through_all"),
    ],
    "core/stability/windup.py": [
        ("outer.sum() *", "0.0 *", WINDUP + "test_the_error_told_is_the_error_there_is[kim]"),
        ("- 2.0 * pi * self.eta**2 * beta", "+ 2.0 * pi * self.eta**2 * beta", OWN),
        ("acceleration = -(push", "acceleration = (push", OWN),
        ("before = i - 1 if", "before = i if", LEAVES + "[12-3.30185]"),
        ("self.force(np.array([middle]))[0] < 0.0", "self.force(np.array([middle]))[0] > 0.0", LEAVES + "[11-2.27504]"),
    ],
    "core/stability/looks.py": [
        ("self.rate[before] - self.rate[after]", "self.rate[before] + self.rate[after]", SAMPLES),
        ("(self.bend[before] + self.bend[after]) / 120.0", "(self.bend[before] + self.bend[after]) / -120.0", SAMPLES),
        ("0.125 * (bend - slope)", "0.125 * (bend + slope)", SAMPLES),
        ("lean - 3.0 * mean + 3.0 * odd", "lean + 3.0 * mean + 3.0 * odd", SAMPLES),
        ("values[before] * values[after] < 0.0", "values[before] * values[after] < -9.0", SAMPLES),
        ("self.bend[moves] / (-2.0 * pi)", "self.bend[moves] / (2.0 * pi)", LEAVES + "[12-3.30185]"),
        ("acceleration) < 0.0", "acceleration) < -0.5", WINDUP + "test_the_follower_leaves_the_cam_where_the_force_first_vanishes"),
        ("gone + beta - first)", "gone - beta - first)", LOOKS),
        ("(1.0 - by_cam * rate)", "1.0", LOOKS),
        ("decay * decay + omega", "omega", LOOKS),
        ("- 2.0 * decay * rate", "+ 2.0 * decay * rate", LOOKS),
    ],
    "core/stability/orbit.py": [
        ("np.eye(2) - matrix, miss", "np.eye(2) + matrix, miss", WINDUP + "test_as_the_load_vanishes_the_last_word_is_that_of_21"),
        ("self.growth <= TOLERANCE", "self.growth > TOLERANCE", REPEATS + "[1.5-0.05]"),
        ("np.linalg.solve(np.eye(2) - matrix, miss)", "np.linalg.solve(np.eye(2) - matrix, -miss)", REPEATS + "[0.85-0.1]"),
        ("np.cross(slopes[0] / SCALE, slopes[1] / SCALE)", "np.cross(slopes[0] / SCALE, slopes[1])",
         WINDUP + "test_along_the_tangent_of_a_branch_nothing_changes"),
    ],
    "core/stability/speeds.py": [
        ("self.natural * RPM / eta", "self.natural / RPM / eta", BANDS),
        ("values[[LOAD, LOAD_SLOPE]] *= eta * eta", "values[[LOAD, LOAD_SLOPE]] *= eta",
         TONGUES + "test_a_fixed_spring_is_the_retuned_one_at_the_speed_it_was_tuned_for"),
        ("unit * b.eta_lo**2", "unit * b.eta_lo", CLEAR + "[retuned]"),
        ("rate = np.where(better, looks[at, top], eta), np.maximum", "rate = np.where(better, looks[at, top], eta), np.minimum", BANDS),
    ],
    "core/stability/paper.py": [
        ("return np.diag(r * r).astype(complex) - toeplitz", "return np.diag(r * r).astype(complex) + toeplitz", ELEVEN + "[False]"),
        ("(0.5 if half else 0.0)", "(-0.5 if half else 0.0)", ELEVEN + "[True]"),
    ],
    "core/stability/means.py": [
        ("np.tile(eta, rows.size), np.repeat(rows, eta.size)", "np.repeat(eta, rows.size), np.tile(rows, eta.size)", EACH),
        ("looks.losing(contact, points.eta[lane])[1]", "(looks.rate >= 1.0)", CLI + "test_the_tables_hold_what_their_columns_say"),
        ("np.where(ended == periods, periods, np.nan)", "np.where(ended > 0.0, periods, np.nan)",
         FIGURES + "test_what_cannot_be_followed_has_no_mean"),
        ("min(round((eta_max - FIRST_ETA) / STEP), MOST)", "round((eta_max - FIRST_ETA) / STEP)",
         FIGURES + "test_a_far_chart_has_no_more_means_than_a_near_one"),
    ],
    "core/stability/figures.py": [
        ("np.where(lost, np.nan, row)", "np.where(lost, row, np.nan)", DASHED),
        ("lost | np.append(lost[1:], False) | np.append(False, lost[:-1])", "lost", DASHED),
        ("Curve(y, gone.at(y)[0]", "Curve(y, gone.at(y)[1]", FIGURES + "test_a_history_is_marked_where_the_follower_leaves_the_cam"),
        ("_by_contact(found, found.slope)", "_by_contact(found, found.wind_up)", DASHED),
        ("DEGREES[:-1]), len(TERMS)", "-DEGREES[:-1] % 360.0), len(TERMS)", FIGURES + "test_terms_are_kims"),
    ],
    "core/stability/stage.py": [
        ("if last is None or last[0] != key:", "if last is None:", FIGURES + "test_the_last_history_is_kept_and_no_other"),
        ("max(ETA_MAX, min(BEYOND", "min(ETA_MAX, min(BEYOND", FIGURES + "test_the_chart_reaches_as_far_as_the_machine"),
        ("np.nanmax(self.exact.error, initial=0.0)", "np.nanmin(self.exact.error, initial=0.0)", REACHED),
        ("[times * m.q for times in TIMES]", "[times for times in TIMES]",
         FIGURES + "test_the_rows_of_a_machine_are_kims_where_its_q_is_kims"),
    ],
    "core/stability/limits.py": [
        ("ERROR if band.growth >= NOTICEABLE", "ERROR if band.growth < NOTICEABLE", LIMITS),
        ("b.distance(rpm) <= CLEAR", "b.distance(rpm) > CLEAR", LIMITS),
    ],
    "core/stability/chart.py": [
        ("np.floor(2.0 * eta_max + 1e-9)", "np.floor(eta_max + 1e-9)", SPEEDS + "test_marked_rows_are_in_sight"),
        ("[[0.5 * n, 0.0]]", "[[1.0 * n, 0.0]]", SPEEDS + "test_the_chart_is_edges_and_the_machine_stands_in_it"),
    ],
    "core/stability/guess.py": [
        ("largest / USUAL_Q", "largest * USUAL_Q", FIGURES + "test_a_first_guess_is_a_usual_shaft"),
        ("(USUAL_ETA * omega) ** 2", "USUAL_ETA * omega**2", FIGURES + "test_a_first_guess_is_a_usual_shaft"),
    ],
    "core/stability/claims.py": [
        ("first.wind_up[first.q <= TWICE]", "first.wind_up[first.q > TWICE]", CLAIMS),
        ("np.abs(rows[LOAD_SLOPE] - slope)", "0.0 * np.abs(rows[LOAD_SLOPE] - slope)", CLI + "test_claims_are_about_kims_cam_only"),
    ],
}  # fmt: skip
