"""Figures of materials and fits: drawn, with units on the axes, the lost range inside the frame."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D

from tactsim.cli.figures.material_curves import fit_figure, material_figure, pressure_unit
from tactsim.identification.uniaxial import FORMS, fit_uniaxial, uniaxial_nominal_stress
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.interfaces import Material
from tactsim.materials.homogeneous import PATHS
from tactsim.materials.library import named_material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.plotting.canvas import encoded
from tactsim.registry import kinds
from tactsim.relaxation import Relaxation

SHIPPED = {name: named_material(name).material for name in ("b1a_printed", "icf_stable")}
QUICK = ("b1a_printed", "linear_elastic", "mooney_rivlin_5")
"""Of lost ellipticity, of small strain, and of the longest name."""
EXAMPLES = {kind: cls.example() for kind, cls in kinds(Material).items()}


def assert_nothing_is_cut(figure: Figure) -> None:
    """The outermost pixels of the saved figure are white."""
    content = encoded(figure)
    assert content.startswith(b"\x89PNG")
    pixels = imread(io.BytesIO(content))[:, :, :3]
    for edge in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
        assert (edge == 1).all()


def test_a_material_that_relaxes_is_drawn_at_once_and_says_so() -> None:
    figure = material_figure(named_material("atrial").material, "atrial")
    assert figure.get_suptitle() == "atrial (neo_hookean), incompressible, G = 18.818 MPa at once, 195.15 Pa in the end"
    assert figure.axes[0].get_ylabel() == "nominal stress at once in MPa"
    assert "nominal stress at once" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_constants_that_hold_in_the_end_are_drawn_as_such() -> None:
    """The figure gave both moduli as the one in the end, and the stress as that at once."""
    relaxation = Relaxation(fractions=(0.5,), times=(2.0,), constants="equilibrium")
    figure = material_figure(NeoHookean(c10=1000.0, relaxation=relaxation), "mine")
    assert figure.get_suptitle() == "mine (neo_hookean), incompressible, G = 4 kPa at once, 2 kPa in the end"
    assert figure.axes[0].get_ylabel() == "nominal stress in the end in kPa"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in (*SHIPPED, *EXAMPLES)]
)
def test_material_figure(name):
    figure = material_figure((SHIPPED | EXAMPLES)[name], name)
    assert [axis.get_title(loc="left") for axis in figure.axes] == list(PATHS)
    assert all(axis.get_xlabel() == "stretch" for axis in figure.axes)
    assert figure.axes[0].get_ylabel() in {f"nominal stress in {unit}" for unit in ("Pa", "kPa", "MPa")}
    assert_nothing_is_cut(figure)


def test_the_lost_range_is_marked_and_inside_the_frame():
    legend = lambda figure: [text.get_text() for text in figure.legends[0].get_texts()]  # noqa: E731
    figure = material_figure(SHIPPED["b1a_printed"], "b1a_printed")
    assert "strong ellipticity lost" in legend(figure)
    assert "strong ellipticity lost" not in legend(material_figure(SHIPPED["icf_stable"], "icf_stable"))
    axis = figure.axes[0]
    marked = next(line for line in axis.lines if line.get_label() == "strong ellipticity lost")
    low, high = axis.get_ylim()
    assert marked.get_xdata().min() == pytest.approx(0.606, abs=5e-3)  # spacing of the drawn points
    assert (marked.get_ydata() >= low).all()
    assert (marked.get_ydata() <= high).all()


def test_the_title_has_the_modulus_and_says_incompressible_only_where_it_is():
    title = lambda name, material: material_figure(material, name).get_suptitle()  # noqa: E731
    assert title("icf_stable", SHIPPED["icf_stable"]) == "icf_stable (mooney_rivlin_3), incompressible, G = 3.5536 kPa"
    assert "incompressible" not in title("lump", LinearElastic.example())


def test_fit_figure():
    stretch = np.append(np.linspace(0.6, 1, 40)[:-1], 1 + 2.3e-16)
    noise = 1 + 0.003 * np.random.default_rng(0).normal(size=stretch.size)
    stress = uniaxial_nominal_stress(SHIPPED["b1a_printed"], stretch) * noise  # a curve that every form fits, the stable ones too
    curve = UniaxialCurve(stretch, stress, "measured")
    fits = [fit_uniaxial(curve, form) for form in FORMS]
    figure = fit_figure(curve, fits, "rubber")
    upper, lower = figure.axes
    assert upper.get_ylabel() == "nominal stress in kPa"
    assert lower.get_ylabel() == "relative error in %"
    assert lower.get_xlabel() == "stretch"
    assert [text.get_text().split(":")[0] for text in upper.get_legend().get_texts()] == ["data", *FORMS]
    largest = 100 * max(fit.max_relative_error for fit in fits)
    assert max(np.abs(line.get_ydata()).max() for line in lower.lines) == pytest.approx(largest, rel=1e-12)
    assert_nothing_is_cut(figure)
    figure.add_artist(Line2D([-0.1, 0.01], [0.5, 0.5]))
    with pytest.raises(AssertionError):
        assert_nothing_is_cut(figure)


@pytest.mark.parametrize(("size", "unit"), [(5.0, "Pa"), (5e3, "kPa"), (5e6, "MPa")])
def test_the_unit_suits_the_size(size, unit):
    chosen, factor = pressure_unit(np.array([size, -size, 0.9 * size]))
    assert chosen == unit
    assert size * factor == pytest.approx(5.0)
