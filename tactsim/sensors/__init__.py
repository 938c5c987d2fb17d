"""What a sensor makes of contact forces: films, electronics, matrices of taxels, threshold sensors and switches."""
