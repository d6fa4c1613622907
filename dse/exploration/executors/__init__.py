"""The executors that come with dse, one a module: its name is the executor's, its EXECUTOR the class."""
