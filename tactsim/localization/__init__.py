"""From the readings of two matrices of sensors to pictures, and to where a lump lies."""
