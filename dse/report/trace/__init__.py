"""A run as a trace file: messages of ASAM OSI, and an MCAP file that Foxglove, Lichtblick and rerun open."""
