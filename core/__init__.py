"""KINDYNA core: cam motion, linkage, shape, dynamics. Never imports Qt."""

__version__ = "0.1.0"
