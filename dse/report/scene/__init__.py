"""A run in three dimensions."""
