"""Studies of many designs: STUDY.toml, the designs that it asks for, their table."""

from core.varying.bands import READY, drive_bands, motor_bands, ready_study, shaft_bands, words_that_go
from core.varying.optimum import Binding, Optimum, optimise, remarks
from core.varying.request import (
    AskedFor,
    Bounded,
    Goal,
    StudyFile,
    StudyOfMany,
    Vary,
    field_info,
    file_of,
    load_study,
    save_study,
    study_of,
)
from core.varying.space import (
    BlockOfDesigns,
    Run,
    Space,
    cache_folder,
    duration,
    evaluated,
    none_built,
    sobol,
    with_words,
    workers,
    write_table,
)
from core.varying.surveys import (
    Limits,
    Made,
    Question,
    Span,
    Survey,
    askable,
    can_be_varied,
    file_of_question,
    made_of,
    present,
    question_of_file,
    refined,
    suggested,
    survey,
    usual_span,
    usual_tolerance,
    whole_numbers,
    with_values,
)
from core.varying.tolerances import Corner, Scatter, Share, Tightened, tolerance_study, waves_of

__all__ = [
    "READY", "AskedFor", "Binding", "BlockOfDesigns", "Bounded", "Corner", "Goal", "Limits", "Made", "Optimum", "Question", "Run",
    "Scatter", "Share", "Space", "Span", "StudyFile", "StudyOfMany", "Survey", "Tightened", "Vary", "askable", "cache_folder",
    "can_be_varied", "drive_bands", "duration", "evaluated", "field_info", "file_of", "file_of_question", "load_study", "made_of",
    "motor_bands", "none_built", "optimise", "present", "question_of_file", "ready_study", "refined", "remarks", "save_study",
    "shaft_bands", "sobol", "study_of", "suggested", "survey", "tolerance_study", "usual_span", "usual_tolerance", "waves_of",
    "whole_numbers", "with_values", "with_words", "words_that_go", "workers", "write_table",
]  # fmt: skip
