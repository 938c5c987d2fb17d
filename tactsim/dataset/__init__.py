"""Data sets: sampling, execution, the Zarr store, reading and checking.

What is heavy is imported by the function that needs it.
"""

from tactsim.dataset.loading import load
from tactsim.dataset.torch_samples import TorchSamples

__all__ = ["TorchSamples", "load"]
