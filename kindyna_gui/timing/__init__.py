"""The timing chart in the window: motions of all drives of a shaft over the machine angle, and what must come after what."""
