"""Synthesis of linkages: four-bars, slider-cranks and inverted slider-cranks for poses, a path, pairs of angles, or a swing."""

# ruff: noqa: F401

from core.synthesis.candidates import FOUR_BAR, INVERTED, SLIDER_CRANK, Candidate
from core.synthesis.dyads import Dyad
from core.synthesis.judge import Answer
from core.synthesis.task import (
    AnglePair,
    AnglePairs,
    AnswerLimits,
    Area,
    BodyPose,
    PathPoint,
    Pivot,
    Swing,
    Task,
    TracedPath,
    load_task,
    save_task,
    task_of,
)
from core.synthesis.tasks import TASKS, Synthesis, synthesise
