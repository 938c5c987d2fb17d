"""Data sets: sampling, execution, the Zarr store, reading and checking.

What is heavy is imported by the function that needs it.
"""

from tactsim.dataset.use.loading import TorchSamples, load, sample_case

__all__ = ["TorchSamples", "load", "sample_case"]
