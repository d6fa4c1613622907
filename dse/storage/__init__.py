"""The study folder: its tables, its waveforms, what is written of them for others."""
