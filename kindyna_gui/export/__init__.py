"""What leaves the program besides the design itself, each with the dialog that asks for it."""
