"""Uniform draws and estimates, by exponential tilting."""
