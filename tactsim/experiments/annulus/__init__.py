"""The rigid annulus by its exact and viscoelastic closed forms."""
