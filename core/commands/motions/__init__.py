"""Commands that begin a design with its motion."""
