"""Valve trains in the window: the form of a cam card, and the timing diagram."""
