"""Suites that show whether what others add to dse is what dse expects; each in a module of its own, run by pytest."""
