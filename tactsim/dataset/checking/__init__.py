"""Whether a data set is what its sweep wrote."""
