"""The multivalued decision diagram of hierarchy and rules, and sums compiled into it."""
