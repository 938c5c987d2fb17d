"""The discrete body: Taylor-Hood space, weak forms and their compiled loops, history variables, loads on its surface."""
