"""Vectors of one position end to end: the polygon of velocities, the polygon of forces on a body, the force in a pin over the turn."""
