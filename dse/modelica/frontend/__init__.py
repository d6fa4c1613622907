"""Modelica files in, the front-end's flat system out: read, instantiated and flattened by rumoca in a process."""
