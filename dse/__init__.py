"""A workbench for designing cyber-physical products when architecture and numbers are both open."""

__version__ = "0.1.0"
