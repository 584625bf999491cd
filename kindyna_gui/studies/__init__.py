"""Numbers of the design varied live: what is varied and asked, curves, map or points, the design as a cross, and the board."""
