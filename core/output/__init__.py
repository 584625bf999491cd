"""Results of a study: channels, tables, summaries, reports and files. These modules read results and compute no mechanics."""
