"""Starts of files that a user goes on with: each is complete, is accepted by ``dse check``, and runs."""
