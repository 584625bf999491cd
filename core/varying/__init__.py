"""Studies of many designs: STUDY.toml, the designs that it asks for, their table."""

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
from core.varying.table import write_table

__all__ = [
    "AskedFor", "BlockOfDesigns", "Bounded", "Goal", "Run", "Space", "StudyFile", "StudyOfMany", "Vary", "cache_folder",
    "duration", "evaluated", "file_of", "load_study", "save_study", "sobol", "study_of", "with_words", "workers", "write_table",
]  # fmt: skip
