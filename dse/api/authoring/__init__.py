"""Designs, benches, studies and components that are defined in Python: by the same keys and rules as in YAML."""
