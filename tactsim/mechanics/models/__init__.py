"""Finite element models: of a section, of tissue in 3D, of a block between jaws, of a body under prescribed loads."""
