"""Where the figures of a table stand: below the last of the rows that they belong to, with what the source says of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from tactsim.validation.comparison import TableOutcome
from tactsim.validation.table import Picture


@dataclass(frozen=True)
class PlacedPicture:
    """A figure of a table with its place and its caption."""

    name: str
    """Name of its file, and of what links point to."""
    title: str
    """What is drawn."""
    says: str
    """What the source says of it."""
    below: str
    """Row that it stands below."""
    rows: Mapping[str, tuple[str, ...]]
    """Class -> rows that it belongs to."""

    @property
    def caption(self) -> str:
        """Title, claim and how each of its rows ended, as plain text."""
        ended = "; ".join(f"{label}: {', '.join(rows)}" for label, rows in self.rows.items())
        return f"{self.title}. {self.says}. Here: {ended}."


def placed_pictures(outcome: TableOutcome) -> list[PlacedPicture]:
    """The figures of a table in its order."""
    labels = {row.row.id: row.label for row in outcome.rows}
    return [placed(outcome.name, figure, picture, labels) for figure, picture in outcome.table.figures.items()]


def placed(table: str, figure: str, picture: Picture, labels: Mapping[str, str]) -> PlacedPicture:
    """A figure beside its rows; ``labels`` holds the class of each row of the table by name, in their order."""
    shown = [row for row in labels if picture.shows(row)]
    by_class: dict[str, tuple[str, ...]] = {}
    for row in shown:
        by_class[labels[row]] = (*by_class.get(labels[row], ()), row)
    return PlacedPicture(f"{table}_{figure}.png", picture.title, picture.says, shown[-1], by_class)


def parts(rows: Sequence[str], pictures: Sequence[PlacedPicture]) -> list[tuple[list[str], list[PlacedPicture]]]:
    """The names of a table's rows cut where a picture stands: each part with those that stand below its last row."""
    cut: list[tuple[list[str], list[PlacedPicture]]] = [([], [])]
    for row in rows:
        if cut[-1][1]:
            cut.append(([], []))
        cut[-1][0].append(row)
        cut[-1][1].extend(picture for picture in pictures if picture.below == row)
    return cut
