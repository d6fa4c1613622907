"""The best rows under an objective, and the Pareto set; whether there is any row."""
