"""Fields between the runs: of a grid, and of runs that lie anywhere."""
