"""Studies of many designs: STUDY.toml, surveys, tolerances, the best design, and tables of results."""

from core.varying.bands import drive_bands, motor_bands, shaft_bands
from core.varying.optimum import Binding, Optimum, optimise, remarks
from core.varying.ready import READY, ready_study, valid_words
from core.varying.request import (
    Goal,
    StudyFile,
    StudyLimit,
    StudyOfMany,
    StudyQuantity,
    VariedField,
    field_info,
    file_of,
    load_study,
    save_study,
    study_of,
)
from core.varying.rounding import rounded_optimum
from core.varying.space import (
    BlockOfDesigns,
    Run,
    Space,
    cache_folder,
    duration,
    none_built_text,
    sobol,
    study_values,
    with_words,
    workers,
    write_table,
)
from core.varying.surveys import (
    Limits,
    Question,
    Span,
    Survey,
    ToleranceResult,
    can_be_varied,
    current_figures,
    default_span,
    default_tolerance,
    file_of_question,
    question_of_file,
    refined_survey,
    request_keys,
    suggested_figures,
    survey,
    tolerance_result,
    whole_numbers,
    with_values,
)
from core.varying.tolerances import Corner, Scatter, Share, TightenedTolerances, tolerance_study
from core.varying.waves import waves_of

__all__ = [
    "READY", "Binding", "BlockOfDesigns", "Corner", "Goal", "Limits", "Optimum", "Question", "Run", "Scatter", "Share",
    "Space", "Span", "StudyFile", "StudyLimit", "StudyOfMany", "StudyQuantity", "Survey", "TightenedTolerances",
    "ToleranceResult", "VariedField", "cache_folder", "can_be_varied", "current_figures", "default_span",
    "default_tolerance", "drive_bands", "duration", "field_info", "file_of", "file_of_question", "load_study",
    "motor_bands", "none_built_text", "optimise", "question_of_file", "ready_study", "refined_survey", "remarks",
    "request_keys", "rounded_optimum", "save_study", "shaft_bands", "sobol", "study_of", "study_values", "suggested_figures", "survey",
    "tolerance_result", "tolerance_study", "valid_words", "waves_of", "whole_numbers", "with_values", "with_words",
    "workers", "write_table",
]  # fmt: skip
