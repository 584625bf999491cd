"""Linkages of other programs: Pyslvs expressions, PMKS+ addresses, .linkage2 files."""

from core.linkage_programs.made import LeftOut, Made
from core.linkage_programs.read import FORMATS, read_linkage

__all__ = ["FORMATS", "LeftOut", "Made", "read_linkage"]
