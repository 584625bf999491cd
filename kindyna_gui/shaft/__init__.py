"""The torque of the whole shaft in the window: over its turn, with flywheel and balance cam, and against its speed."""
