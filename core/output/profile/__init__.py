"""The profile of a cam, or the path of its cutter, as a file for machines and drawings, with the deviation that it reaches."""

from core.output.profile.drawing import ProfileDrawing
from core.output.profile.files import FORMATS, Format, facts_text, files, format_of, job_of, write
from core.output.profile.fits import FITS
from core.output.profile.points import LEAST_POINTS, MOST_POINTS, SAMPLINGS
from core.output.profile.request import ALL_FLANKS, Machining, Request, flank_choice

__all__ = [
    "ALL_FLANKS", "FITS", "FORMATS", "LEAST_POINTS", "MOST_POINTS", "SAMPLINGS", "Format", "Machining",
    "ProfileDrawing", "Request", "facts_text", "files", "flank_choice", "format_of", "job_of", "write",
]  # fmt: skip
