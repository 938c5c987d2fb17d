"""Bodies inside a block of tissue: one kind per file, each a closed surface known exactly."""
