"""What rows of thesis tables can compute; one kind per file."""
