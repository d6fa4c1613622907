"""A tool server for assistants: questions about a workspace and its studies, over the Model Context Protocol."""
