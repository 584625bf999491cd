"""What the user prefers: kept in the settings, and followed by the window."""
