"""Optima and proofs by OR-tools CP-SAT, where a decision diagram is too large or late."""
