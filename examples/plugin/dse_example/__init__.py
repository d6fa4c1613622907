"""What a package can add to dse."""
