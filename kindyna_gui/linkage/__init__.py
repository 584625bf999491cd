"""The mechanism: drawing, instant centres, circle diagram, velocity polygon."""
