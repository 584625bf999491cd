"""What is wrong with a design, and what holds: views of its findings and of its certificate."""
