"""Tables of electronic cams for controllers: files, what a controller makes of them, and how far that is from the exact curve."""
