"""The samplers that come with dse, one a module: its name is the sampler's, its SAMPLER the class."""
