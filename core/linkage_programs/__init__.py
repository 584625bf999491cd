"""Import of linkages from other programs: Pyslvs expressions, PMKS+ addresses, .linkage2 files."""

from core.linkage_programs.design import FORMATS, LinkageImport, read_linkage
from core.linkage_programs.readers import LeftOut

__all__ = ["FORMATS", "LeftOut", "LinkageImport", "read_linkage"]
