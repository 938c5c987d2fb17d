"""A probe with an array of switches drawn over tissue."""
