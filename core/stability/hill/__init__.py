"""Hill's equation of the flexible camshaft, ζ'' + 4π²(η² w + p) ζ = 0: coefficients, matrices, edges of its tongues."""
