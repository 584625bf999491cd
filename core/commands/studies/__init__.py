"""The commands about studies of many designs."""
