"""Plots of a design: channels over the cam angle, curves of any tables, and quantities over the machine speed."""
