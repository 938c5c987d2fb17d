"""From the signal of a film to a voltage, to a number, and back to a force."""
