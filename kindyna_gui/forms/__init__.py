"""Forms and tables: one row for each value of the design."""
