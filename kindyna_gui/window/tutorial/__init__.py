"""Lessons that are played at the window: read, shown step by step, and played by themselves."""
