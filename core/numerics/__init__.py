"""Mathematics without mechanics: vectors, derivatives, lazy values, sums with their rounding, cancellation."""
