"""File > Import measured motion and Import controller table: motions from tables."""
