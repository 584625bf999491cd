"""Files of a cam: its profile, workshop drawing and inspection, with the deviation of each."""
