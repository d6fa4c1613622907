"""How things are shown: in words and units, as tables for notebooks and data frames, as a bar of progress."""
