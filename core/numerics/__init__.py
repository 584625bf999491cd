"""Mathematics without mechanics: vectors, derivatives, roots, quadrature, lazy values, cancellation."""
