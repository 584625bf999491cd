"""Make > Blend and Make > Blend a sequence: motions composed of elementary curves."""
