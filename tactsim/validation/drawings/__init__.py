"""What figures of thesis tables can show; one kind per file."""
