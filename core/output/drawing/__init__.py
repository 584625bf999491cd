"""Mechanisms, curves and plots as drawings, and their files."""
