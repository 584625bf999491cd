"""Linkages of other programs: Pyslvs expressions, PMKS+ addresses, .linkage2 files."""

from core.linkage_programs.design import FORMATS, Made, read_linkage
from core.linkage_programs.readers import LeftOut

__all__ = ["FORMATS", "LeftOut", "Made", "read_linkage"]
