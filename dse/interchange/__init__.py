"""System Structure and Parameterization (SSP 1.0 and 2.0): packages are read, resolved and written."""
