"""The colour map of pressures and forces, the same in every figure and on the page."""

from __future__ import annotations

PRESSURE_COLOURS = "viridis"
"""Its lightness rises evenly from dark to bright, so that it reads alike in grey print and with any colour blindness, and its
hues are far enough apart to distinguish one level from the next, which those of cividis, most of them grey, are not.

Source: S. van der Walt & N. Smith 2015, https://bids.github.io/colormap; compared by J. Nunez, C. Anderton & R. Renslow 2018,
doi:10.1371/journal.pone.0199239.
"""
