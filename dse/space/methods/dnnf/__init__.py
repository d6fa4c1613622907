"""Exact answers for wide Boolean spaces, such as feature models, by a decision-DNNF."""
