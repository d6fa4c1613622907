"""Somebody at the wheel of a bench, live."""
