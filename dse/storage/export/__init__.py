"""What is written of a study for other programs."""
