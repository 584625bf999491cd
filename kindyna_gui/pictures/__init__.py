"""Every drawing, on screen and to file. Nothing here computes mechanics."""
