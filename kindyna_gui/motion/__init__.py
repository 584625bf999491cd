"""Motion: diagram and table of the segments, law picker, law table."""
