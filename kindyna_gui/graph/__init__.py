"""Curves over the cam angle."""
