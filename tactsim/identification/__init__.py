"""Constants from measurements: uniaxial curves."""
