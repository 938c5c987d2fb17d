"""Linear systems: direct factors, factors that are reused, and the iteration for bodies too large for a factor."""
