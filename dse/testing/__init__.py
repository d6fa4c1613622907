"""Suites of tests for what others add to dse; they need pytest."""
