"""The figures of the papers in a window of their own."""
