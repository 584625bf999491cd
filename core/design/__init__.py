"""Inputs: what the user typed, its units, ranges and rules. The face of the room: what is imported here is what it offers."""

# ruff: noqa: F401

from typing import TYPE_CHECKING

from core.design.balancer import Balancer
from core.design.camshaft import (
    BALANCER,
    RESERVED,
    add_drive,
    as_list,
    copy_drive,
    drive_at,
    drive_in,
    drive_names,
    drive_of,
    free_name,
    in_machine,
    move_drive,
    numbered,
    only,
    path_in,
    path_of,
    remove_drive,
    rename_drive,
    reorder_timing,
    slug,
    slugs,
    with_only,
    with_phase,
    with_timing,
)
from core.design.edits import (
    edited,
    rescaled,
    scale_text,
    stretched,
    stroke,
    with_elastic,
    with_face,
    with_form,
    with_law,
    with_layout,
    with_rise,
    with_segment_inserted,
    with_shaft,
    with_span,
    with_spans,
    with_stroke,
    without_segment,
)
from core.design.element_rules import FOLLOWER_LINKS, link_names, link_points, pairs_of
from core.design.elements import (
    ELEMENT_LISTS,
    Attachment,
    ForceElements,
    LoadPoint,
    PairFriction,
    PointSpring,
    Process,
    TorsionSpring,
)
from core.design.faces import (
    ContactFriction,
    Face,
    Flat,
    Knife,
    OffsetFlat,
    Roller,
    Rolling,
    RoundFace,
    Shoe,
    TiltedFlat,
)
from core.design.fields import Info, info_of, unit_of
from core.design.forms import FORMS, Conjugate, Form, Groove, LinkageConjugate, Open, SecondLinkRoller, SecondRoller
from core.design.limits import NO_LIMITS, Limits, Tolerance, Waviness
from core.design.linkage import (
    CRANK,
    DRIVERS,
    FRAME_LINK,
    MOTION,
    MOTION_SPEED,
    NO_DRIVER,
    Drawn,
    Driver,
    Link,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    SecondDriver,
    Side,
    Slider,
)
from core.design.parts import (
    CURVES,
    FOLLOWER_KINDS,
    LAYOUTS,
    OUTPUT_LOADS,
    SENSES,
    SPRINGS,
    Cam,
    CamSlider,
    CamSliderLoads,
    ComputedCurve,
    Curve,
    DiskCam,
    ElasticShaft,
    Follower,
    FollowerKind,
    Follows,
    Loads,
    Motion,
    NamedCurve,
    Origin,
    Oscillating,
    OscillatingFlat,
    OscillatingFlatLoads,
    OscillatingLoads,
    Output,
    OutputLoads,
    PolynomialCurve,
    PolynomialEnd,
    RollerCam,
    SccaCurve,
    SecondArm,
    SecondPlace,
    Segment,
    Servo,
    Shaft,
    SlideLoads,
    SplineCurve,
    SplinePoint,
    TableCurve,
    Translating,
    TranslatingLoads,
    TurnLoads,
    curve_of,
    face_of,
    kind_of,
)
from core.design.paths import (
    Entry,
    all_paths,
    entries,
    get,
    is_assumed,
    names_a_link,
    put,
    row_at,
    with_assumed,
    with_guesses_marked,
)
from core.design.rules import blunders, faults, part_faults, whole_faults
from core.design.timing import Stroke, TimingDistance, contradiction, distances, events, excess, named_event, strokes
from core.design.units import SI, si
from core.design.whole import SECTIONS, STAGES, Design, Drive, TimingRow, require_linkage, with_drive, with_table
from core.late import late
from core.units import NO_UNIT, UNITS, Unit, split_unit

if TYPE_CHECKING:
    from core.design.element_edits import (
        HOLDS,
        LINK,
        MOTION_PART,
        PAIR,
        POINT,
        TABLE,
        TURN_PART,
        AttachedEnd,
        Held,
        PairPlace,
        holds_of,
        load_lists,
        places_for,
        when_of,
        whens_of,
        with_held,
        with_load_table,
        with_new_row,
        with_rows_in_order,
        with_table_row,
        with_when,
    )
    from core.design.joins import (
        LEAST_SPAN,
        join_angles,
        join_levels,
        join_range,
        joins_of_level,
        with_join_moved,
    )
    from core.design.mirror import has_image, mirrored, stroke_mirrored
    from core.design.motions import (
        alone,
        insert_segment,
        mirror_stroke,
        motion_of,
        move_join,
        remove_segment,
        require_motion,
        turns_on,
        with_motion,
        with_motion_of,
    )
    from core.design.timing_moves import (
        AngleRoom,
        events_at,
        join_room,
        machine_joins,
        milliseconds,
        moving,
        phase_room,
        together,
        turn_drive,
        turn_join,
    )
    from core.design.unfinished import (
        closed,
        closed_design,
        lacks,
        laid_out,
        merged,
        one_value_apart,
        remove_laid_out,
        rise_gap,
        span_gap,
    )
else:
    __getattr__ = late(__name__, "unfinished", "joins", "mirror", "motions", "element_edits", "timing_moves")
