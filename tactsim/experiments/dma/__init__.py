"""Constants of a viscoelastic model identified from dynamic mechanical analysis."""
