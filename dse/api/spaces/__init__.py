"""Design spaces and the questions to them."""
