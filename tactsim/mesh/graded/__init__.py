"""Grids of cells that repeat: graded from the faces, bent around boxes of rounded cells about lumps, or mapped onto bodies."""
