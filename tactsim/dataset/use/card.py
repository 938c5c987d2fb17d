"""A data set in words: what ``tactsim data info`` prints, and the card, README.md in its folder, written anew after every run."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np

from tactsim.dataset.cost import slow_lines
from tactsim.dataset.sampling.layout import Layout
from tactsim.dataset.sampling.settings import Splits
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import PENDING
from tactsim.dataset.store.files import CARD, FIGURES
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import refuse_redescribed
from tactsim.dataset.use.counts import (
    costs_of,
    empty_splits,
    failures,
    never_drawn,
    redrawn,
    split_counts,
    split_shares,
    status_counts,
    status_lines,
    warnings_of,
)
from tactsim.dataset.use.loading import refuse_half_extended
from tactsim.outside.text import aligned, markdown_table, one_line
from tactsim.storage.own_files import OWN_LIST, OwnFiles

TAGS = "tags: [tactile, simulation, tactsim]"
"""Line in the head of a card by which one is recognised that was written before tactsim listed its files."""
SPECIAL = str.maketrans({character: f"\\{character}" for character in "\\`<[]"} | {"|": "/"})
"""Characters that begin code, tags and links, escaped; a bar would end the cell of a table."""
GENERAL_LIMITS = (
    "Simulated, not measured: the sensor's film and electronics are models, and tissue is homogeneous but for what is named.",
    "Failed samples, if there are any, are not random: they gather where the tissue is squeezed most.",
    "Numbers repeat on one machine and with the same versions; across machines expect differences of about 1e-8. Meshes of kind "
    "`tetrahedra` repeat only on Linux with x86-64 processors: elsewhere each machine makes its own, whose taxels differ by up "
    "to half a per cent.",
)
MOST_OPTIONS = 10
"""Most options without a sample that the card names."""
LIKELY = 0.99
"""Probability with which enough specimens put one into every split."""


def write_card(store: Store, sweep: Sweep, layout: Layout) -> None:
    """Writes the card.

    Raises
    ------
    ForeignFile
        If another file stands in its place, which is kept.
    """
    OwnFiles(store.path).replace(CARD, card_text(store, sweep, layout).encode())


def adopt_earlier_files(path: Path, figures: Sequence[str]) -> None:
    """Lists card and figures that an earlier tactsim wrote, which kept no list of its files."""
    card, files = path / CARD, OwnFiles(path)
    if (path / OWN_LIST).exists() or not card.is_file() or card.is_symlink():
        return
    with open(card, "rb") as file:
        head = file.read(1000).decode("utf-8", "replace")
    if TAGS in head.splitlines():
        for name in (CARD, *(f"{FIGURES}/{figure}" for figure in figures)):
            files.adopt(name)


def plain(text: object) -> str:
    """Text of others on one line that cannot break the Markdown around it."""
    return one_line(text).translate(SPECIAL)


def card_text(store: Store, sweep: Sweep, layout: Layout) -> str:
    """The card in Markdown."""
    attributes = store.attributes
    title = plain(attributes["title"] or f"Data set {attributes['sweep_id']}")
    bounds = ranges(store)
    head = ["---", f"license: {plain(attributes['license']).lower()}", TAGS, "---", f"# {title}", ""]
    parts = [
        layout.recorder.describe(),
        "",
        *_how(store, sweep),
        *_counts(store, sweep),
        *_figures(store.path),
        *_use(layout, {name for name, _, least, largest in bounds if least != largest}),
        *_limits(attributes["limits"]),
    ]
    tables = [*_table("Ranges", ("variable", "unit", "least", "largest"), bounds)]
    tables += _table("Variables", ("variable", "dimensions beside sample", "unit", "meaning"), variable_rows(store))
    case = ["## The sweep", "```json", json.dumps(json.loads(attributes["sweep"]), indent=1), "```", ""]
    return "\n".join([*head, *parts, *tables, *case])


def _how(store: Store, sweep: Sweep) -> list[str]:
    attributes, settings = store.attributes, sweep.settings
    versions = plain(", ".join(f"{name} {number}" for name, number in attributes["versions"].items()))
    shared = f" {sweep.per_specimen} samples share a specimen." if sweep.per_specimen > 1 else ""
    hypercube = " (and on the number of samples: a Latin hypercube)" if settings.design == "latin_hypercube" else ""
    specimens, draws = redrawn(store)
    return [
        "## How it was made",
        f"Design {settings.design}, seed {settings.seed}, {store.samples} samples.{shared}",
        f"Sample k depends on the seed and on k only{hypercube}.",
        f"Draws whose case is impossible are drawn again: {draws} draws of {specimens} specimens were refused.",
        f"Computed by tactsim {plain(', '.join(attributes['codes']))}; {versions}.",
        "",
        *(plain(line) if line[0] != " " else f"- {plain(line.strip())}" for line in slow_lines(costs_of(store))),
        "",
    ]


def _counts(store: Store, sweep: Sweep) -> list[str]:
    rows = [(name, str(count)) for name, count in status_counts(store).items()]
    counts = split_counts(store)
    splits = [(name, str(count)) for name, count in counts.items()]
    lines = _table("Counts", ("status", "samples"), rows) + _table("Splits, by specimen", ("split", "samples done"), splits)
    if sweep.per_specimen > 1 and (apart := sweep.settings.splits.out_of_distribution):
        lines += [f"One sample that satisfies the rule of {' or '.join(apart)} takes all samples of its specimen there.", ""]
    lines += [*map(plain, never_drawn_lines(store, sweep)), *empty_split_lines(counts, sweep.settings.splits), ""]
    failed = [(one.text, str(one.count), one.which) for one in failures(store)]
    warned = [(one.text, str(one.count), one.which) for one in warnings_of(store)]
    lines += _table("Failures", ("reason", "samples", "first"), failed) if failed else []
    return lines + (_table("Warnings of samples that are done", ("warning", "samples", "first"), warned) if warned else [])


def absent_lines(store: Store, sweep: Sweep) -> list[str]:
    """What a data set lacks although every sample was computed: options that none has, and parts that are empty."""
    return [*never_drawn_lines(store, sweep), *empty_split_lines(split_counts(store), sweep.settings.splits)]


def never_drawn_lines(store: Store, sweep: Sweep) -> list[str]:
    """A sentence on each option that no sample has because its cases were refused."""
    return [
        f"warning: no sample has {option} for {key}, which {100 * share:.3g} % of the draws have: their cases were refused "
        "and drawn again; run such a case to see why, or leave that option out."
        for key, option, share in never_drawn(store, sweep)[:MOST_OPTIONS]
    ]


def empty_split_lines(counts: Mapping[str, int], splits: Splits) -> list[str]:
    """A sentence on parts of the data set without a sample that is done, if there are any, by the counts of those."""
    empty, lines = empty_splits(counts, splits), []
    shares = {name: share for name, share in split_shares(splits).items() if name in empty}
    if shares:
        which = f"the splits {', '.join(shares)} have" if len(shares) > 1 else f"the split {next(iter(shares))} has"
        needed = _specimens_needed(min(shares.values()))
        lines = [f"warning: {which} no sample that is done; take more samples ({needed}), or other shares in sweep.splits."]
    if rules := [name for name in empty if name not in shares]:
        remedy = "take more samples, or compare its bounds, in SI, with the ranges of the labels on the card"
        lines.append(f"warning: no sample that is done satisfies the rule of {' or '.join(rules)}; {remedy}.")
    return lines


def _specimens_needed(share: float) -> str:
    """How many specimens make it likely that a part with a share has one, if each of them fell to it by that chance alone."""
    count = int(np.ceil(np.log(1 - LIKELY) / np.log1p(-share))) if share < 1 else 1
    return f"a share of {100 * share:.3g} % has a specimen with a probability of at least {100 * LIKELY:g} % among {count}"


def _figures(path: Path) -> list[str]:
    files = OwnFiles(path)
    drawn = sorted(name for name in files.sums() if name.startswith(f"{FIGURES}/") and files.written(name))
    return ["## Figures", *(f"![{Path(name).stem}]({name})" for name in drawn), ""] if drawn else []


def _use(layout: Layout, varying: Collection[str] = ()) -> list[str]:
    """How to read the store, with code that learns a label that is ``varying``, if there is one."""
    readings, labels = (_widest_first(layout, role) for role in ("reading", "label"))
    labels = [name for name in labels if name in varying] or labels
    chosen = [name for name in ("read_force", "force") if name in readings] or readings
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


def _widest_first(layout: Layout, role: str) -> list[str]:
    """Variables that are numbers, the largest first, and of these the forces: forces of all taxels and a centre, not the error
    of a mesh and a count, and no times.
    """
    variables = [variable for variable in layout.variables if variable.role == role and variable.dtype != "str"]
    variables.sort(key=lambda variable: (-math.prod(variable.sizes), variable.unit != "N"))
    return [variable.name for variable in variables]


def _limits(stated: str) -> list[str]:
    return [
        "## Known limits",
        *(f"- {line}" for line in GENERAL_LIMITS),
        *(f"- {plain(line.strip())}" for line in stated.splitlines() if line.strip()),
        "",
    ]


def _table(title: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    return [f"## {title}", *markdown_table(head, (map(plain, row) for row in rows)), ""]


def description(path: str | Path) -> str:
    """What ``tactsim data info`` prints.

    Raises
    ------
    StorageError
        If the folder is not a data set, its description is damaged or was changed, or a run was killed while it made room.
    """
    store = Store.open(path)
    refuse_half_extended(store)
    refuse_redescribed(store)
    attributes = store.attributes
    lines = [one_line(attributes["title"] or path), f"  {one_line(attributes['description'])}"]
    lines += [f"  licence {one_line(attributes['license'], 80)}, sweep {one_line(attributes['sweep_id'], 80)}"]
    lines += [*status_lines(store), *(f"  {name:<28} {count}" for name, count in split_counts(store).items())]
    counts = status_counts(store)
    lines += [f"  {one.of(counts['done'] + counts['failed'])}: failed: {one.text}" for one in failures(store)]
    lines += [f"  {one.of(counts['done'])}: warning: {one.text}" for one in warnings_of(store)]
    lines += [f"  {line}" for line in slow_lines(costs_of(store))]
    lines += aligned(variable_rows(store), left=4, indent="  ")
    return "\n".join([*lines, *(f"  {one_line(name):<36} is gone; tactsim data check says more" for name in store.missing)])


def variable_rows(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, dimensions, unit and meaning of every variable."""
    rows = []
    for name, array in store.described.items():
        sizes = zip(array.dimensions[1:], array.shape[1:], strict=True)
        shape = ", ".join(f"{one_line(dimension)} {size}" for dimension, size in sizes)
        units, meaning = (one_line(array.attributes[key]) for key in ("units", "long_name"))
        if names := one_line(array.attributes.get("flag_meanings", "")).split():
            meaning += f": {', '.join(f'{number} {word}' for number, word in enumerate(names))}"
        rows.append((name, shape, units, meaning))
    return rows


def ranges(store: Store) -> list[tuple[str, str, str, str]]:
    """Name, unit, least and largest value of every varied number and label of the computed samples."""
    computed = np.flatnonzero(store.read("status") != PENDING)
    rows = []
    for name, array in store.described.items():
        if array.attributes["role"] not in ("varied", "label") or array.dtype == "str" or not computed.size:
            continue
        values = np.asarray(store.read(name, computed), dtype=float)
        finite = values[np.isfinite(values)]
        low, high = (f"{finite.min():.4g}", f"{finite.max():.4g}") if finite.size else ("-", "-")
        rows.append((name, one_line(array.attributes["units"]), low, high))
    return rows
