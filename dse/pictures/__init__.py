"""Pictures of boxes and lines, as SVG."""
