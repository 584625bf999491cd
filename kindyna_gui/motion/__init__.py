"""The motion: displacement diagram, table of segments, curves and laws."""
