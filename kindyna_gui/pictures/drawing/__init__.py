"""The drawing of a mechanism, on the screen and to file."""
