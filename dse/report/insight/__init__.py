"""What a study asked and what its runs tell, computed for the page from the stored runs alone."""
