"""The dock Study: vary numbers of the design, compare many designs, find the best one, and save designs on a board."""
