"""`study.sqlite`: its tables, and what stands in them as nouns."""
