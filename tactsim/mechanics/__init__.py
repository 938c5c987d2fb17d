"""A body with rigid bodies against it: models of section and block, equilibrium with contact, paths in load and in time."""
