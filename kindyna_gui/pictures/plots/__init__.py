"""Plots, on the screen and to file."""
