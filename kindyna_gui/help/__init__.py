"""The help: its pages, and the keys that lead there."""
