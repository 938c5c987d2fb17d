"""The card of a data set: README.md in its folder, written anew after every run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from tactsim.dataset.description import empty_splits, failures, ranges, redrawn, split_counts, status_counts, variable_rows
from tactsim.dataset.layout import Layout
from tactsim.dataset.store import Store
from tactsim.dataset.store_files import CARD, FIGURES
from tactsim.dataset.sweep import Sweep
from tactsim.outside.text import one_line
from tactsim.storage.own_files import OWN_LIST, OwnFiles

TAGS = "tags: [tactile, simulation, tactsim]"
"""A line of the head by which a card is known that was written before there were lists of own files."""
SPECIAL = str.maketrans({character: f"\\{character}" for character in "\\`<[]"} | {"|": "/"})
"""Characters that begin code, tags and links, escaped; a bar would end the cell of a table."""
GENERAL_LIMITS = (
    "Simulated, not measured: the sensor's film and electronics are models, and tissue is homogeneous but for what is named.",
    "Failed samples, if there are any, are not random: they gather where the tissue is squeezed most.",
    "Numbers repeat on one machine and with the same versions; across machines expect differences of about 1e-8.",
)


def write_card(store: Store, sweep: Sweep, layout: Layout) -> None:
    """Writes the card.

    Raises
    ------
    ForeignFile
        If another file stands in its place, which is kept.
    """
    OwnFiles(store.path).replace(CARD, card_text(store, sweep, layout).encode())


def adopt_earlier_files(path: Path, figures: Sequence[str]) -> None:
    """Counts card and figures as own that a tactsim wrote which kept no list of them."""
    card, own = path / CARD, OwnFiles(path)
    if (path / OWN_LIST).exists() or not card.is_file() or card.is_symlink():
        return
    with open(card, "rb") as file:
        head = file.read(1000).decode("utf-8", "replace")
    if TAGS in head.splitlines():
        for name in (CARD, *(f"{FIGURES}/{figure}" for figure in figures)):
            own.adopt(name)


def plain(text: object) -> str:
    """Text of others on one line that cannot break the Markdown around it."""
    return one_line(text).translate(SPECIAL)


def card_text(store: Store, sweep: Sweep, layout: Layout) -> str:
    """The card in Markdown."""
    told = store.attributes
    title = plain(told["title"] or f"Data set {told['sweep_id']}")
    head = ["---", f"license: {plain(told['license']).lower()}", TAGS, "---", f"# {title}", ""]
    parts = [
        layout.recorder.describe(),
        "",
        *_how(store, sweep),
        *_counts(store, sweep),
        *_figures(store.path),
        *_use(layout),
        *_limits(told["limits"]),
    ]
    tables = [*_table("Ranges", ("variable", "unit", "least", "largest"), ranges(store))]
    tables += _table("Variables", ("variable", "dimensions beside sample", "unit", "meaning"), variable_rows(store))
    case = ["## The sweep", "```json", json.dumps(json.loads(told["sweep"]), indent=1), "```", ""]
    return "\n".join([*head, *parts, *tables, *case])


def _how(store: Store, sweep: Sweep) -> list[str]:
    told, settings = store.attributes, sweep.settings
    versions = plain(", ".join(f"{name} {number}" for name, number in told["versions"].items()))
    shared = f"{sweep.per_specimen} samples share a specimen. " if sweep.per_specimen > 1 else ""
    hypercube = " (and on the number of samples: a Latin hypercube)" if settings.design == "latin_hypercube" else ""
    specimens, draws = redrawn(store)
    return [
        "## How it was made",
        f"Design {settings.design}, seed {settings.seed}, {store.samples} samples. {shared}",
        f"Sample k depends on the seed and on k only{hypercube}.",
        f"Draws whose case is impossible are drawn again: {draws} draws of {specimens} specimens were refused.",
        f"Computed by tactsim {plain(', '.join(told['codes']))}; {versions}.",
        "",
    ]


def _counts(store: Store, sweep: Sweep) -> list[str]:
    rows = [(name, str(count)) for name, count in status_counts(store).items()]
    counts = split_counts(store)
    splits = [(name, str(count)) for name, count in counts.items()]
    told = _table("Counts", ("status", "samples"), rows) + _table("Splits, by specimen", ("split", "samples done"), splits)
    told += [*empty_split_lines(empty_splits(counts, sweep.settings.splits)), ""]
    failed = [(reason, str(count)) for reason, count in failures(store)]
    return told + (_table("Failures", ("reason", "samples"), failed) if failed else [])


def empty_split_lines(names: Sequence[str]) -> list[str]:
    """A sentence on parts of the data set without a sample, if there are any."""
    if not names:
        return []
    which = f"the split {names[0]} has" if len(names) == 1 else f"the splits {', '.join(names)} have"
    return [f"warning: {which} no sample that is done; take more samples, or other shares in sweep.splits."]


def _figures(path: Path) -> list[str]:
    own = OwnFiles(path)
    drawn = sorted(name for name in own.sums() if name.startswith(f"{FIGURES}/") and own.written(name))
    return ["## Figures", *(f"![{Path(name).stem}]({name})" for name in drawn), ""] if drawn else []


def _use(layout: Layout) -> list[str]:
    readings, labels = (_names(layout, role) for role in ("reading", "label"))
    chosen = [name for name in ("read_force", "force") if name in readings] or readings[:1]
    inputs, targets = json.dumps(chosen[:1]), json.dumps(labels[:1] or readings[-1:])
    return [
        "## Reading",
        "With xarray alone:",
        "```python",
        "import xarray",
        'data = xarray.open_zarr("STORE")',
        "done = data.isel(sample=(data.status == 1).values)  # 0 pending, 1 done, 2 failed",
        "```",
        "In a notebook with tactsim, one part of the samples that are done:",
        "```python",
        "from tactsim.dataset import load",
        'train, test = load("STORE", split="train"), load("STORE", split="test")',
        "train",
        "```",
        "As PyTorch's loaders take it:",
        "```python",
        "from torch.utils.data import DataLoader",
        "from tactsim.dataset import TorchSamples",
        f'samples = TorchSamples("STORE", inputs={inputs}, targets={targets}, split="train")',
        "loader = DataLoader(samples, batch_size=64, shuffle=True, num_workers=8)",
        "```",
        "Split by `split` (numbers: attribute flag_meanings), never by sample: samples may share a specimen.",
        "The meanings of variables below say which have noise; `_clean` are the same readings without it.",
        "",
    ]


def _names(layout: Layout, role: str) -> list[str]:
    return [variable.name for variable in layout.variables if variable.role == role and variable.dtype != "str"]


def _limits(own: str) -> list[str]:
    return [
        "## Known limits",
        *(f"- {line}" for line in GENERAL_LIMITS),
        *(f"- {plain(line)}" for line in own.splitlines() if line.strip()),
        "",
    ]


def _table(title: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    cells = [" | ".join(plain(cell) for cell in row) for row in rows]
    return [f"## {title}", f"| {' | '.join(head)} |", "|" + " --- |" * len(head), *(f"| {row} |" for row in cells), ""]
