"""``tactsim material``: shipped materials, those of a case, and fits to a measured curve."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tactsim.cli import command_list, console
from tactsim.errors import InputError

if TYPE_CHECKING:
    from tactsim.identification.uniaxial import UniaxialFit
    from tactsim.interfaces import Material

NAME = "material"
SUMMARY = "constants, stability and curves of a material; fits to measured curves"
DESCRIPTION = """\
Without an argument lists the materials that ship with tactsim. With a name, or a case,
prints the constants, the small-strain moduli and the range of stretch in which each material
is stable. With --fit reads a uniaxial curve (CSV with a header such as
"strain [%], nominal stress [kPa]", also as a testing machine writes it), fits every form of
the energy, and prints the lines to put into a case file, each constant with its interval of
95 %. A stress that is not called true is taken as nominal. A curve should hold the strains
that the tissue will undergo and few others: --strains. --save draws the
curves. With --relaxation reads what relaxes at a held deformation (CSV with a header such as
"time [s], stress [kPa]") and prints its Prony series.
"""
EXAMPLES = """\
examples:
  tactsim material
  tactsim material icf_stable --save icf.png
  tactsim material annulus_icf
  tactsim material --fit my_rubber.csv --form stable --save fit.png
  tactsim material --fit my_rubber.csv --strains 0.05 1 --absolute
  tactsim material --relaxation held.csv --rise "0.2 s"
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    what = parser.add_mutually_exclusive_group()
    what.add_argument("material", metavar="NAME|CASE", nargs="?", help="name of a shipped material, or a case")
    what.add_argument("--fit", metavar="CURVE.csv", type=Path, help="fit a measured uniaxial curve")
    what.add_argument("--relaxation", metavar="CURVE.csv", type=Path, help="fit a Prony series to a measured relaxation")
    parser.add_argument("--rise", metavar="TIME", help="with --relaxation: how long the deformation rose; a step without it")
    strains = "with --fit: use the curve between two strains only, such as 0 1"
    parser.add_argument("--strains", nargs=2, type=float, metavar=("FROM", "TO"), help=strains)
    parser.add_argument("--absolute", action="store_true", help="with --fit: noise of one size, not in proportion to the stress")
    parser.add_argument("--form", metavar="FORM", help="with --fit: report this form of the energy only")
    parser.add_argument("--save", metavar="FILE.png", type=Path, help="save the curves")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    TactsimError
        Whatever ends the command with an exit code of its own, such as options that do not go together.
    """
    _check_image(arguments.save)
    if arguments.rise is not None and arguments.relaxation is None:
        raise InputError("--rise goes with --relaxation")
    if arguments.relaxation is not None and (arguments.form or arguments.save or arguments.absolute or arguments.strains):
        raise InputError("--form, --strains, --absolute and --save go with --fit; --relaxation prints its Prony series")
    if arguments.relaxation is not None:
        return _relaxation(arguments)
    if arguments.fit is not None:
        return _fit(arguments)
    given = [name for name in ("form", "absolute", "strains") if getattr(arguments, name)]
    if given:
        raise InputError(f"--{given[0]} goes with --fit")
    if arguments.material is None:
        if arguments.save is not None:
            raise InputError("--save needs a material to draw")
        console.out("\n".join(command_list.listed("materials")))
        return 0
    return _report(arguments)


def _report(arguments: argparse.Namespace) -> int:
    from tactsim.materials.report import material_report

    materials = _materials(arguments.material)
    console.out("\n\n".join(material_report(name, material) for name, material in materials.items()))
    if arguments.save is not None:
        from tactsim.cli.figures.material_curves import encoded, material_figure

        for name, material in materials.items():
            place = arguments.save if len(materials) == 1 else _numbered(arguments.save, name)
            _save(encoded(material_figure(material, name)), place)
    return 0


def _relaxation(arguments: argparse.Namespace) -> int:
    from tactsim.identification.relaxation_curve import fit_relaxation
    from tactsim.units import parse_quantity

    rise = 0.0 if arguments.rise is None else parse_quantity(arguments.rise, "s")
    fit = fit_relaxation(arguments.relaxation, rise=rise)
    console.out(str(fit))
    for warning in fit.warnings:
        console.note(f"note: {warning}")
    return 0


def _fit(arguments: argparse.Namespace) -> int:
    from tactsim.errors import ConvergenceError, InvalidQuantity
    from tactsim.identification.uniaxial import FORMS, fit_uniaxial, spread_of_forms
    from tactsim.identification.uniaxial_advice import advice
    from tactsim.identification.uniaxial_certainty import large_strains, wrong_signs
    from tactsim.identification.uniaxial_data import read_uniaxial_curve

    curve = read_uniaxial_curve(arguments.fit)
    if arguments.strains is not None:
        curve = curve.within(*arguments.strains)
    for warning in (*large_strains(curve), *wrong_signs(curve)):
        console.note(f"note: {warning}")
    fits: list[UniaxialFit] = []
    refused: list[str] = []
    for form in [arguments.form] if arguments.form else FORMS:
        try:
            fits.append(fit_uniaxial(curve, form, relative=not arguments.absolute))
        except (ConvergenceError, InvalidQuantity) as error:
            if arguments.form:
                raise
            refused.append(f"{form}: no fit: {error}")
    for fit in fits:
        console.out(str(fit))
    for line in (*refused, *filter(None, [advice(fits)])):
        console.out(line)
    if not fits:
        raise InputError(f"{arguments.fit}: no form of the energy fits this curve")
    left_open = fits[0].certainty.warnings(fits[0].max_relative_error) if arguments.form else ()
    for warning in (*left_open, *spread_of_forms(fits)):
        console.note(f"note: {warning}")
    if arguments.save is not None:
        from tactsim.cli.figures.material_curves import encoded, fit_figure

        _save(encoded(fit_figure(curve, fits, arguments.fit.stem)), arguments.save)
    return 0


def _materials(name: str) -> dict[str, Material]:
    """The shipped material of this name, or every material of a case, by its key path."""
    from tactsim.case import load_case
    from tactsim.materials.library import LIBRARY, named_material
    from tactsim.shipped import shipped_cases

    is_case = Path(name).suffix in (".yaml", ".yml") or Path(name).exists() or name in {place.stem for place in shipped_cases()}
    if name in LIBRARY or not is_case:
        return {name: named_material(name).material}
    materials = dict(_inside(load_case(name).experiment, ()))
    if not materials:
        raise InputError(f"{name}: the case has no material")
    return materials


def _inside(value: object, path: tuple[str, ...]) -> list[tuple[str, Material]]:
    """Every material in a value, with its key path."""
    from tactsim.interfaces import Material
    from tactsim.interfaces.seeds import entries

    if isinstance(value, Material):
        return [(".".join(path), value)]
    return [pair for name, item in entries(value) for pair in _inside(item, (*path, name))]


def _numbered(place: Path, name: str) -> Path:
    return place.with_name(f"{place.stem}-{name.replace('.', '-')}{place.suffix}")


def _check_image(place: Path | None) -> None:
    if place is not None and place.suffix.lower() != ".png":
        raise InputError(f"--save {place}: the figure is a PNG file; its name must end in .png")


def _save(image: bytes, place: Path) -> None:
    from tactsim.storage.files import replace_file

    replace_file(place, image)
    console.out(f"figure {place}")
