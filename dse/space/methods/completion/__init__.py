"""One row that meets preferences in their order, each as far as it can still be had; what is left open is drawn."""
