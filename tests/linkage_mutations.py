"""The changes of ``mutations.py`` that concern linkages: file -> (what stands there, what shall, the test that must fail)."""

MECHANISM, CENTRES, STUDY = (f"tests/core/test_{name}.py::" for name in ("mechanism", "instant_centres", "linkage_study"))
DYNAMICS, FILES = (f"tests/core/test_{name}.py::" for name in ("linkage_dynamics", "linkage_files"))
CERTIFICATE = "tests/core/test_linkage_certificate.py::"
LECTURE = "tests/validation/test_velocity_lecture.py::"

CLOSES = MECHANISM + "test_any_linkage_closes_and_stands_where_it_was_drawn"
COMPLEX = MECHANISM + "test_velocities_are_complex_step_derivatives"
SERIES = MECHANISM + "test_three_derivatives_are_those_of_a_power_series"
GROUP = MECHANISM + "test_a_group_is_solved_like_the_others"
PARALLEL = MECHANISM + "test_a_parallelogram_stays_one_through_its_change_points"
THROUGH = MECHANISM + "test_a_slider_goes_on_through_the_pivot"
SWINGS = MECHANISM + "test_a_crank_that_cannot_turn_moves_between_two_dead_centres"
DRAGGED = "tests/core/test_dragging.py::test_a_joint_of_any_linkage_lands_where_it_is_put"
NEAR_END = MECHANISM + "test_near_a_dead_centre_errors_stay_below_condition_times_four_eps"
REACTIONS = DYNAMICS + "test_every_reaction_is_a_multiplier_of_the_loop_equations"
GROUP_FORCES = DYNAMICS + "test_a_groups_reactions_too"
BALANCE = DYNAMICS + "test_power_and_momentum_balance"
CAM = DYNAMICS + "test_the_cam_takes_the_place_of_the_driver"
LIFT_FORCES = DYNAMICS + "test_the_lift_as_a_linkage_has_the_lifts_forces"
ONE_LINE = CENTRES + "test_any_three_bodies_centres_lie_on_one_line"
ONE_VELOCITY = CENTRES + "test_two_bodies_have_one_velocity_at_their_centre"
RATIOS = CENTRES + "test_ratios_by_centres_are_those_of_the_loop_equations"
KENNEDY = CENTRES + "test_kennedys_construction_finds_the_centres_that_velocities_give"
POLYGON, PROOF = (f"tests/core/test_{name}.py::" for name in ("velocity_polygon", "linkage_proof"))
CLOSED, ONE_PICTURE = POLYGON + "test_every_triangle_closes", POLYGON + "test_the_polygon_is_one_picture_from_one_pole"
ARMS = POLYGON + "test_directed_distances_give_the_ratio"
LIFT_CAM = STUDY + "test_the_lift_seen_as_a_linkage_gets_the_lifts_cam"
RATES = STUDY + "test_rates_are_by_time_with_the_cranks_sense"

DRAGGING, DRIVERS = (f"tests/core/test_{name}.py::" for name in ("dragging", "linkage_drivers"))
LANDS = DRAGGING + "test_a_joint_of_the_cam_slider_lands_where_it_is_put_and_the_others_stay"
LEADS = DRIVERS + "test_whatever_leads_the_linkage_goes_on_from_where_it_stands"

LINKAGE_MUTATIONS: dict[str, list[tuple[str, str, str]]] = {
    "core/derivatives.py": [
        ("(1.0, 2.0, 1.0)", "(1.0, 1.0, 1.0)", GROUP),
        ("(1.0, 3.0, 3.0, 1.0)", "(1.0, 3.0, 2.0, 1.0)", SERIES),
        ("_joined(a, b, np.add, np.positive)", "_joined(a, b, np.subtract, np.negative)", CLOSES),
        ("_joined(a, b, np.subtract, np.negative)", "_joined(a, b, np.subtract, np.positive)", COMPLEX),
        ("BINOMIAL[order][:-1]))", "BINOMIAL[order]))", SERIES),
        ("if order or first is None else first()", "if order or first is None else 0.0 * first()", SERIES),
    ],
    "core/vectors.py": [("else u * (1j * a1)", "else u * (-1j * a1)", COMPLEX)],
    "core/mechanism/dyads.py": [
        ("np.add(sum_and_difference, square", "np.subtract(sum_and_difference, square", CLOSES),
        ("ends.imag = k", "ends.imag = -k", CLOSES),
        ("inverse = -2.0 / k", "inverse = 2.0 / k", COMPLEX),
        ("row += end.imag * d[order].imag", "row -= end.imag * d[order].imag", COMPLEX),
        ("known[0] -= alpha * between", "known[0] += alpha * between", SERIES),
        ("known[0] += (lb * lb) * beta", "known[0] -= (lb * lb) * beta", SERIES),
        ("known[1] -= (la * la) * alpha", "known[1] += (la * la) * alpha", SERIES),
        ("known[1] += beta * between", "known[1] -= beta * between", SERIES),
        ("else 3.0 * w * turns[2]", "else 2.0 * w * turns[2]", SERIES),
        ("known += w * w * w", "known -= w * w * w", SERIES),
        ("np.asarray(c - dot(path[0], t[0]))", "np.asarray(c + dot(path[0], t[0]))", CLOSES),
        ("-cross(known, t[0]) * inverse", "cross(known, t[0]) * inverse", COMPLEX),
        ("-dot(known, to_joint) * inverse", "dot(known, to_joint) * inverse", COMPLEX),
        ("offset = own.imag - other.imag", "offset = own.imag + other.imag", CLOSES),
        ("[cross(along, known) * inverse", "[-cross(along, known) * inverse", COMPLEX),
        ("beside(between, t1, y)", "beside(between, t1, -y)", CLOSES),
    ],
    "core/mechanism/closing.py": [
        ("factor.real, factor.imag = -3.0 * w * angle[2]", "factor.real, factor.imag = 3.0 * w * angle[2]", SERIES),
        ("return -(w * w) * u", "return (w * w) * u", SERIES),
        ("cross(t1[0], known) * inverse", "-cross(t1[0], known) * inverse", CLOSES),
    ],
    "core/mechanism/groups.py": [
        ("-= dot(direction, gap) / group.size", "+= dot(direction, gap) / group.size", CLOSES + " " + GROUP),
        ("arm = 1j * held.point", "arm = -1j * held.point", GROUP),
    ],
    "core/mechanism/solving.py": [
        ("pin = standing(on.point)", "pin = standing(-on.point)", CLOSES),
        ("placed(pin, own.point,", "placed(pin, -own.point,", CLOSES),
        ("q[order] * on.along", "-q[order] * on.along", LIFT_CAM),
    ],
    "core/mechanism/way.py": [
        ("np.where(passed % 2 == 0, stated, -stated)", "stated", PARALLEL),
        ("by_q[1] * v,", "-by_q[1] * v,", PARALLEL),
        ("by_q[2] * v * v + by_q[1] * a,", "by_q[1] * a,", THROUGH),
    ],
    "core/mechanism/course.py": [
        ("if b - a > _STANDS * (high - low)", "if True",
         STUDY + "test_a_linkage_that_stands_at_single_positions_only_has_no_range"),
        ("angle + TURN * np.rint((np.interp(", "angle - TURN * np.rint((np.interp(",
         MECHANISM + "test_angles_do_not_jump_within_the_turn"),
        ("if (gap(place + scale", "if True or (gap(place + scale", MECHANISM + "test_a_gap_between_samples_is_found"),
    ],
    "core/mechanism/ranges.py": [
        ("(low * right + high * left) / (left + right)", "(low * left + high * right) / (left + right)",
         PROOF + "test_guides_that_turn_parallel_are_a_dead_centre_with_its_angle"),
        ("for sign in (1.0, -1.0):", "for sign in ():", MECHANISM + "test_a_gap_between_samples_is_found"),
        ("good, bad = np.where(moving & keeps, middle, good)", "good, bad = np.where(moving & ~keeps, middle, good)", SWINGS),
    ],
    "core/mechanism/rounding.py": [
        ("np.where(np.isnan(worst), np.inf, 4.0 * worst + 4.0)", "4.0 * worst + 4.0",
         CERTIFICATE + "test_a_crank_that_stops_at_a_dead_centre_has_a_certificate"),
        ("closed.reach * (2.0 +", "1e-3 * closed.reach * (2.0 +", PROOF + "test_the_stated_doubt_counts_the_rods_themselves"),
    ],
    "core/mechanism/grashof.py": [
        ("if surplus > 0.0:", "if surplus < 0.0:", MECHANISM + "test_a_four_bar_turns_where_grashof_says_so"),
        ('"coupler": rods[1 - frame_side]', '"coupler": rods[frame_side]',
         MECHANISM + "test_a_four_bar_turns_where_grashof_says_so"),
    ],
    "core/mechanism/limits.py": [
        ("if turns_fully and locked:", "if turns_fully and not locked:",
         PROOF + "test_dead_centres_open_ranges_and_circuits_are_told_with_their_angles"),
        ("at = degrees(change.at) if", "at = change.at if", PROOF + "test_change_points_are_told_where_the_circuits_meet"),
    ],
    "core/mechanism/assembly.py": [
        ("ends.append(pose.derivative(held.point, 0))", "ends.append(pose.derivative(1.01 * held.point, 0))",
         PROOF + "test_newtons_residual_stands_in_the_certificate"),
        ("found[f\"slide{joint.name}\"] = _slide(bodies, joint)", "found[f\"slide{joint.name}\"] = -_slide(bodies, joint)",
         STUDY + "test_the_columns_of_the_six_bar_hold_what_their_names_say"),
        ("np.asarray(forward / np.abs(forward))", "np.asarray(1j * forward / np.abs(forward))", LIFT_CAM),
    ],
    "core/mechanism/dragging.py": [
        ("(to - origin) * axis.conjugate()", "(to - origin) * axis", DRAGGED),
        ("places[name] = (to - origin)", "places[name] = (to + origin)", DRAGGING + "test_a_joint_of_any_linkage_lands_where_it_is_put"),
        ("return old + axis * ((to - old)", "return old + axis * ((to + old)", DRAGGING + "test_a_point_that_slides_keeps_to_its_guide"),
        ("return start + along * ((to - start)", "return start - along * ((to - start)",
         DRAGGING + "test_a_point_of_the_crank_keeps_to_its_line"),
    ],
    "core/linkage/dragging.py": [
        ("base.alpha - phi - g.guide_angle", "base.alpha - phi + g.guide_angle", DRAGGING + "test_a_turned_guide_is_followed"),
        ("(arm * end.conjugate()).imag", "(arm.conjugate() * end).imag", LANDS),
        ("end.real - float(train.motion.y[0, 0])", "end.real + float(train.motion.y[0, 0])", LANDS),
        ("start.real > l1 * math.cos(phi)", "start.real < l1 * math.cos(phi)", LANDS),
        ("base.phi + fixed + g.guide_angle", "base.phi - fixed + g.guide_angle", LANDS),
        ("(first / -pivot).imag < 0.0", "(first / -pivot).imag > 0.0", LANDS),
        ("place.real - float(train.motion.y[0, 0])", "place.real",
         DRAGGING + "test_the_roller_of_a_translating_follower_lands_where_it_is_put"),
    ],
    "core/mechanism/drivers.py": [
        ("product((1, -1), repeat", "product((1,), repeat", LEADS),
        ("min(max(place, low), high), low, high)", "place, place - 3.0, place + 3.0)", LEADS),
        ("least = _NEAR * (here.high - here.low)", "least = -1.0", DRIVERS + "test_a_link_at_its_dead_centre_leads_nothing"),
        ("if ahead >= behind else -1.0", "if ahead < behind else -1.0", DRIVERS + "test_a_first_motion_goes_as_far_as_the_linkage_lets_it"),
    ],
    "core/instant_centres/linkage.py": [
        ("+ 1j * (b.origin[1] - a.origin[1])", "- 1j * (b.origin[1] - a.origin[1])", ONE_VELOCITY),
        ("across = 1j * pair.axis", "across = pair.axis", LECTURE + "test_the_circle_diagram_of_the_slider_crank"),
        ("rest = length <= _AT_REST * speed", "rest = length < 0.0", CENTRES + "test_a_body_at_rest_has_the_limit_of_its_centres"),
    ],
    "core/instant_centres/construction.py": [
        ("cut = np.cross(one, other, axis=0)", "cut = one + other", KENNEDY),
        ("if len(triangles) > 1 else None", "if len(triangles) > 0 else None", KENNEDY),
    ],
    "core/instant_centres/velocities.py": [
        ("common.point * held.weight - held", "common.point * held.weight + held", RATIOS),
        ("own.weight * above / (other.weight * below)", "other.weight * above / (own.weight * below)", RATIOS),
        ("np.where(ratio < 0.0, -body_arm, body_arm)", "body_arm", ARMS),
        ("to_base / (common.weight * other.weight)", "to_base / (common.weight * own.weight)", ARMS),
        ("np.where(own.far(table.size), np.inf,", "np.where(False, np.inf,",
         POLYGON + "test_a_coupler_that_does_not_turn_has_an_infinite_arm"),
        ("return key in table.primary and bool(", "return key not in table.primary and bool(",
         LECTURE + "test_the_lectures_way_through_the_six_bar"),
        ("return 1.0 / angular_ratio(table, output, driver)", "return angular_ratio(table, output, driver)",
         PROOF + "test_the_mechanical_advantage_is_that_of_the_forces"),
    ],
    "core/instant_centres/differences.py": [
        ("turned = 1j * body.turn[1]", "turned = -1j * body.turn[1]", CLOSED),
        ("(body.points[p] - body.points[a])", "(body.points[p] + body.points[a])", CLOSED),
        ("body.place(a, 1), turned, body.place(p, 1))", "body.place(p, 1), turned, body.place(a, 1))", CLOSED),
        ("under = line.origin[1] + 1j", "under = line.origin[1] - 1j", CLOSED),
        ("dot(speed - under, axis) * axis", "dot(speed - under, axis) * axis * 1j", CLOSED),
        ("axis = pair.axis * first.unit", "axis = pair.axis * 1j", POLYGON + "test_a_block_on_a_turning_arm_slides_along_it"),
        ("= (pair.on, pair.body) if swapped", "= (pair.on, pair.body) if not swapped",
         POLYGON + "test_a_block_on_a_turning_arm_slides_along_it"),
        ("Side(d.kind, d.body, start, end, d.v_pa)", "Side(d.kind, d.body, end, start, d.v_pa)", ONE_PICTURE),
        ("Side(ABSOLUTE, owner, POLE, key, velocity)", "Side(ABSOLUTE, owner, POLE, key, -velocity)",
         LECTURE + "test_velocity_differences_of_the_six_bar"),
        ("corners[key] = velocity", "corners[key] = 1j * velocity", ONE_PICTURE),
        ("(point not in fixed, point not in joined[:1])", "(point in fixed, point not in joined[:1])",
         POLYGON + "test_the_four_bars_triangles"),
    ],
    "core/position.py": [
        ("complex(v[0]) * study.omega for v", "complex(v[0]) for v", LECTURE + "test_the_command_prints_the_printed_figures"),
    ],
    "core/centring.py": [
        ("_plain(arms.base_arm[0] * _MM)", "_plain(arms.base_arm[0])", LECTURE + "test_the_command_prints_the_printed_figures"),
        ("_vector(row.v_pa)", "_vector(row.v_p - 2.0 * row.v_pa)", LECTURE + "test_the_command_prints_the_printed_figures"),
        ("math.degrees(centre.direction[0])", "centre.direction[0]", LECTURE + "test_the_command_prints_the_printed_figures"),
    ],
    "core/instant_centres/cam.py": [
        ("turn * pole.point / pole.weight, point)", "-turn * pole.point / pole.weight, point)",
         STUDY + "test_a_cam_under_a_coupler_moves_its_four_bar[60.0]"),
        ("np.where(told, np.maximum(doubt, 1.0), 1.0)", "1.0",
         CERTIFICATE + "test_a_pole_far_away_is_as_certain_as_its_lines"),
    ],
    "core/cam/limits.py": [
        ("if not (hold > 16.0 * EPS * train.condition).any():", "if False:",
         CERTIFICATE + "test_a_roller_that_goes_round_the_cam_centre_is_no_cam[four_bar]"),
    ],
    "core/dynamics/linkage.py": [
        ("(1j * c2 * q1 - 1j * c1 * q2)", "(1j * c2 * q1 + 1j * c1 * q2)", REACTIONS),
        ("turning = walk.about(a, pin_b) + walk.about(b, pin_b)", "turning = walk.about(a, pin_b) - walk.about(b, pin_b)", REACTIONS),
        ("both = walk.force[a] + walk.force[b]", "both = walk.force[b]", REACTIONS),
        ("couple = -self.about(body, at)", "couple = self.about(body, at)", REACTIONS),
        ("self.load(other, at, -force, -couple)", "self.load(other, at, -force, couple)", REACTIONS + " " + BALANCE),
        ("(loading.gravity - square * centre[2])", "(loading.gravity + square * centre[2])", REACTIONS),
        ("(cross(at, pull) + couple)", "(cross(at, pull) - couple)", GROUP_FORCES + " " + CAM),
        ("pressing = -needed / lever", "pressing = needed / lever", CAM),
        ("camshaft = -sense * cross", "camshaft = sense * cross", CAM),
        ("needed = -dot(t, walk.force[driver])", "needed = dot(t, walk.force[driver])",
         DYNAMICS + "test_a_driver_that_slides_is_given_a_force"),
    ],
    "core/study/linkage.py": [
        ("return np.fmax(1.0, size / np.abs(self.dynamics.lever))", "return np.ones(1)",
         CERTIFICATE + "test_a_force_through_a_steep_cam_is_as_certain_as_its_hold"),
        ("return longest * self.samples < 4.0", "return False and longest * self.samples < 4.0",
         STUDY + "test_a_crank_that_can_hardly_move_is_refused_where_no_angle_lies_in_its_range"),
        ("return speed if self.by_crank else abs(speed)", "return abs(speed)", RATES),
        ("np.sign(self.design.linkage.driver.speed_rpm)", "abs(np.sign(self.design.linkage.driver.speed_rpm))",
         STUDY + "test_a_cam_under_a_coupler_moves_its_four_bar[-60.0]"),
    ],
    "core/study/linkage_quantities.py": [
        ("coordinates[name][order] * s.omega**order", "coordinates[name][order]", RATES),
        ("return at * study.omega**order", "return at", RATES),
    ],
    "core/design/topology.py": [
        ("3 * (len(linkage.links) - 1) - 2 * pair_count(linkage)", "3 * len(linkage.links) - 2 * pair_count(linkage)",
         MECHANISM + "test_three_links_on_one_pin_are_two_pairs"),
        ("sum(len(pin.links) - 1 for pin", "sum(1 for pin", MECHANISM + "test_three_links_on_one_pin_are_two_pairs"),
    ],
}  # fmt: skip
"""Several tests, parted by a blank: one of them must fail."""
