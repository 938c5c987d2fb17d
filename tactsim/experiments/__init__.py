"""What a case can ask for, one file each."""
