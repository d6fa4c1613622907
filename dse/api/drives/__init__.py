"""Drives as runs: kept in a folder, simulated again as a study, and compared on a score board."""
