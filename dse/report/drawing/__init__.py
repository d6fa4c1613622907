"""Drawing for print, with matplotlib."""
