"""Meshes of quadratic elements: sections, bodies of revolution and blocks with inclusions; made, read, refined, and kept."""
