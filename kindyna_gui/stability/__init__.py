"""Stability of the flexible camshaft."""
