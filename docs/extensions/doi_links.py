"""Turns ``doi:10.1000/182`` in running text into a link, on the written pages and in the docstrings."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform

DOI = re.compile(r"doi:(10\.\d{4,9}/[^\s,;|]+)")
INSIDE = (nodes.reference, nodes.literal, nodes.literal_block, nodes.math, nodes.math_block, nodes.title)
"""What holds text that is left as it is."""


def setup(app: Sphinx) -> dict[str, Any]:
    """Connects what this module does to Sphinx."""
    app.add_transform(DoiLinks)
    return {"parallel_read_safe": True}


class DoiLinks(SphinxTransform):
    """Makes the links."""

    default_priority = 800

    def apply(self, **options: Any) -> None:
        """Replace every text that names one."""
        for text in list(self.document.findall(nodes.Text)):
            if DOI.search(text) and not _within(text, INSIDE):
                text.parent.replace(text, _linked(str(text)))


def _within(node: nodes.Node, kinds: tuple[type, ...]) -> bool:
    while (parent := node.parent) is not None:
        if isinstance(parent, kinds):
            return True
        node = parent
    return False


def _linked(text: str) -> list[nodes.Node]:
    parts: list[nodes.Node] = []
    position = 0
    for match in DOI.finditer(text):
        name = identifier(match[1])
        end = match.start(1) + len(name)
        parts += [
            nodes.Text(text[position : match.start()]),
            nodes.reference("", f"doi:{name}", refuri=f"https://doi.org/{name}"),
        ]
        position = end
    return [*parts, nodes.Text(text[position:])]


def identifier(found: str) -> str:
    """The identifier without the full stop or the parenthesis of the sentence around it."""
    while found.endswith((".", ":")) or (found.endswith(")") and found.count(")") > found.count("(")):
        found = found[:-1]
    return found
