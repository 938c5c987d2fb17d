"""A data set as PyTorch's loaders take it; PyTorch itself is needed only when a sample is taken."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.dataset.loading import load
from tactsim.errors import InputError


class TorchSamples:
    """A map-style data set: ``(inputs, targets)`` of one sample, two mappings from variable to a tensor of 32-bit floats.

    The store is opened in each process when its first sample is taken, so that any number of loader workers share nothing.
    Whole numbers stay whole. NaN of padded inclusions stays NaN.
    """

    def __init__(
        self,
        store: str | Path,
        *,
        inputs: Sequence[str],
        targets: Sequence[str] = (),
        split: str | Iterable[str] | None = None,
        transform: Callable[[dict[str, Any], dict[str, Any]], Any] | None = None,
    ):
        whole = load(store, split=split, variables=dict.fromkeys((*inputs, *targets, "status")))
        for name in (*inputs, *targets):
            if whole[name].dtype.kind not in "fiub":
                raise InputError(f"{name} holds text, which a tensor cannot; take numbers")
        self.store, self.inputs, self.targets, self.transform = str(store), tuple(inputs), tuple(targets), transform
        self.numbers = whole["sample"].values
        self._opened: tuple[int, dict[str, Any]] | None = None

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: int) -> Any:
        return self.__getitems__([index])[0]

    def __getitems__(self, indices: Sequence[int]) -> list[Any]:
        """Several samples by one reading of each chunk, which PyTorch's loaders ask for."""
        values = {name: self._tensors(name, self.numbers[list(indices)]) for name in (*self.inputs, *self.targets)}
        samples = []
        for row in range(len(indices)):
            inputs, targets = ({name: values[name][row] for name in names} for names in (self.inputs, self.targets))
            samples.append(self.transform(inputs, targets) if self.transform else (inputs, targets))
        return samples

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}

    def _tensors(self, name: str, numbers: np.ndarray) -> Any:
        import torch

        values = np.asarray(self._arrays()[name].oindex[numbers])
        return torch.from_numpy(np.array(values, dtype=np.float32 if values.dtype.kind == "f" else np.int64))

    def _arrays(self) -> dict[str, Any]:
        """The arrays of this process."""
        if self._opened is None or self._opened[0] != os.getpid():
            from tactsim.dataset.store import Store

            store = Store.open(self.store)
            self._opened = os.getpid(), {name: store.array(name) for name in (*self.inputs, *self.targets)}
        return self._opened[1]
