"""Worker processes on this machine, watched: no finished run is lost, whatever an FMU does."""
