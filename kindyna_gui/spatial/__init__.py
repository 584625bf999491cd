"""Views of a cam in space."""
