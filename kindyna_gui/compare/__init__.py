"""What differs from a pinned variant, and where a number comes from."""
