"""Commands of linkages: from other programs, and out."""
