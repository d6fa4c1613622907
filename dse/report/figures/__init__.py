"""The figures: every module here holds one under its own name (`dse.report.figure` says what a figure is)."""
