"""Studies of many designs: STUDY.toml, the designs that it asks for, their table."""

from core.varying.optimum import Binding, Optimum, optimise
from core.varying.remarks import remarks
from core.varying.request import (
    AskedFor,
    Bounded,
    Goal,
    StudyFile,
    StudyOfMany,
    Vary,
    file_of,
    load_study,
    save_study,
    study_of,
)
from core.varying.run import BlockOfDesigns, Run, cache_folder, duration, workers
from core.varying.space import Space, evaluated, sobol, with_words
from core.varying.surveys import (
    Span,
    Survey,
    askable,
    can_be_varied,
    file_of_survey,
    made_within,
    present,
    suggested,
    survey,
    usual_span,
    with_values,
)
from core.varying.table import write_table
from core.varying.tolerances import Corner, Scatter, Share, Tightened, tolerance_study
from core.varying.waves import waves_of

__all__ = [
    "AskedFor", "Binding", "BlockOfDesigns", "Bounded", "Corner", "Goal", "Optimum", "Run", "Scatter", "Share", "Space", "Span",
    "StudyFile", "StudyOfMany", "Survey", "Tightened", "Vary", "askable", "cache_folder", "can_be_varied", "duration",
    "evaluated", "file_of", "file_of_survey", "load_study", "made_within", "optimise", "present", "remarks", "save_study", "sobol",
    "study_of", "suggested", "survey", "tolerance_study", "usual_span", "waves_of", "with_values", "with_words", "workers",
    "write_table",
]  # fmt: skip
