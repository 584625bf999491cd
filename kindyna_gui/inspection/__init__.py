"""Inspection of a cut cam: the table of lift before it is written, and a measured table on the profile."""
