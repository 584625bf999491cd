"""Sheets of paper: reports, tables, charts, figures."""
