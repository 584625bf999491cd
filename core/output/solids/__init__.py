"""Surfaces and solids of cams and plates as STEP, STL and CSV: outlines, walls and caps, bodies of edges and faces."""
