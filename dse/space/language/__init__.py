"""What a constraint means: names, kinds of values, exact evaluation."""
