"""Charts as plain values, what is wrong with one, and how large ones are thinned."""
