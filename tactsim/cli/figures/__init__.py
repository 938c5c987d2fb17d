"""What the command line draws: curves of materials, and the figures of a result."""
