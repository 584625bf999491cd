"""Motions from drawings."""
