"""Motions from measured tables."""
