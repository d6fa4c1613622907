"""What a report shows: plain values in display units, read from a study folder."""
