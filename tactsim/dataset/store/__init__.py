"""The Zarr store of a data set: what lies in it, how it is written, opened and verified."""
