"""Dialogs of the files of a cam: profile, workshop drawing, controller table; surfaces and solid."""
