"""Compo > Find a linkage: a task drawn on a sheet, and the linkages found for it."""
