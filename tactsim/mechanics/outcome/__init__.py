"""What a run with contact records, and whether it is a success."""
