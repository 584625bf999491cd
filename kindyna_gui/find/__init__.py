"""Dimensions sought: what is wanted, its limits, what it is traded for, and the answer."""
