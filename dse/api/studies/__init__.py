"""Benches and studies, and the runs that are made of them."""
