"""What leaves a study: channels, tables, summaries, reports and files. Everything here reads results and computes no mechanics."""
