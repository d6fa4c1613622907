"""Choosing a configuration step by step in the terminal."""
