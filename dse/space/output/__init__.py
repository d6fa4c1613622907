"""Configurations as tables and files, and the picture of a design space."""
