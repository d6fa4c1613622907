"""Conformance suites: what every kind, figure, metric function, … must do, as tests a package runs over its own."""
