"""Physics simulation of tactile sensing on soft tissue: hyperelastic contact, sensors, localization.

::

    import tactsim as ts

    case = ts.load_case("annulus_icf", {"experiment.recess": "0.4 mm"})
    result = case.run()
    result["threshold_pressure"].to("kPa")

Every name of `__all__` is loaded when it is first used. Bodies, films, figures and all other kinds that a case file can name are
found with `kinds`; the bases from which new ones are derived stand in `tactsim.interfaces`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tactsim.presenter import presented_by
from tactsim.version import __version__ as __version__

if TYPE_CHECKING:
    from tactsim.case.loading import load_case
    from tactsim.case.model import Case
    from tactsim.case.writing import save_case
    from tactsim.contact.annulus import Annulus
    from tactsim.contact.coulomb import Coulomb
    from tactsim.dataset.running.whole import sweep
    from tactsim.dataset.use.loading import load as load_data
    from tactsim.errors import InputError, TactsimError
    from tactsim.experiments.annulus.closed_form import ClosedForm
    from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
    from tactsim.experiments.grasp.grasp import Grasp
    from tactsim.experiments.grasp.setup import Block, Embedded
    from tactsim.experiments.indentation.indentation import Indentation
    from tactsim.experiments.indentation.timed_indentation import TimedIndentation
    from tactsim.identification.relaxation_curve import fit_relaxation
    from tactsim.identification.uniaxial import fit_uniaxial
    from tactsim.identification.uniaxial_data import read_uniaxial_curve
    from tactsim.interfaces import Estimator, Experiment, Inclusion, Material, RigidBody, SensorFilm
    from tactsim.interfaces.points import kinds
    from tactsim.interfaces.taxel_layout import TaxelLayout
    from tactsim.interfaces.variation import choice, log_uniform, normal, uniform
    from tactsim.materials.library import material
    from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
    from tactsim.materials.neo_hookean import NeoHookean
    from tactsim.mechanics.models.specimen import Specimen
    from tactsim.mechanics.paths.loading import close
    from tactsim.mesh.inclusions.ellipsoid import Ellipsoid
    from tactsim.mesh.inclusions.sphere import Sphere
    from tactsim.mesh.inclusions.tube import Tube
    from tactsim.presentation import load_result
    from tactsim.relaxation import Relaxation
    from tactsim.results.quantity import Quantity
    from tactsim.results.result import Result

__all__ = [
    "Annulus",
    "Block",
    "BoundaryValueProblem",
    "Case",
    "ClosedForm",
    "Coulomb",
    "Ellipsoid",
    "Embedded",
    "Estimator",
    "Experiment",
    "Grasp",
    "Inclusion",
    "Indentation",
    "InputError",
    "Material",
    "MooneyRivlin3",
    "NeoHookean",
    "Quantity",
    "Relaxation",
    "Result",
    "RigidBody",
    "SensorFilm",
    "Specimen",
    "Sphere",
    "TactsimError",
    "TaxelLayout",
    "TimedIndentation",
    "Tube",
    "choice",
    "close",
    "fit_relaxation",
    "fit_uniaxial",
    "kinds",
    "load_case",
    "load_data",
    "load_result",
    "log_uniform",
    "material",
    "normal",
    "read_uniaxial_curve",
    "save_case",
    "sweep",
    "uniform",
]

_PLACES = {
    "Annulus": "tactsim.contact.annulus:Annulus",
    "Block": "tactsim.experiments.grasp.setup:Block",
    "BoundaryValueProblem": "tactsim.experiments.boundary_value.boundary_value_problem:BoundaryValueProblem",
    "Case": "tactsim.case.model:Case",
    "ClosedForm": "tactsim.experiments.annulus.closed_form:ClosedForm",
    "Coulomb": "tactsim.contact.coulomb:Coulomb",
    "Ellipsoid": "tactsim.mesh.inclusions.ellipsoid:Ellipsoid",
    "Embedded": "tactsim.experiments.grasp.setup:Embedded",
    "Estimator": "tactsim.interfaces:Estimator",
    "Experiment": "tactsim.interfaces:Experiment",
    "Grasp": "tactsim.experiments.grasp.grasp:Grasp",
    "Inclusion": "tactsim.interfaces:Inclusion",
    "Indentation": "tactsim.experiments.indentation.indentation:Indentation",
    "InputError": "tactsim.errors:InputError",
    "Material": "tactsim.interfaces:Material",
    "MooneyRivlin3": "tactsim.materials.mooney_rivlin_3:MooneyRivlin3",
    "NeoHookean": "tactsim.materials.neo_hookean:NeoHookean",
    "Quantity": "tactsim.results.quantity:Quantity",
    "Result": "tactsim.results.result:Result",
    "Relaxation": "tactsim.relaxation:Relaxation",
    "RigidBody": "tactsim.interfaces:RigidBody",
    "SensorFilm": "tactsim.interfaces:SensorFilm",
    "Specimen": "tactsim.mechanics.models.specimen:Specimen",
    "Sphere": "tactsim.mesh.inclusions.sphere:Sphere",
    "TactsimError": "tactsim.errors:TactsimError",
    "TaxelLayout": "tactsim.interfaces.taxel_layout:TaxelLayout",
    "TimedIndentation": "tactsim.experiments.indentation.timed_indentation:TimedIndentation",
    "Tube": "tactsim.mesh.inclusions.tube:Tube",
    "choice": "tactsim.interfaces.variation:choice",
    "close": "tactsim.mechanics.paths.loading:close",
    "fit_relaxation": "tactsim.identification.relaxation_curve:fit_relaxation",
    "fit_uniaxial": "tactsim.identification.uniaxial:fit_uniaxial",
    "kinds": "tactsim.interfaces.points:kinds",
    "load_case": "tactsim.case.loading:load_case",
    "load_data": "tactsim.dataset.use.loading:load",
    "load_result": "tactsim.presentation:load_result",
    "log_uniform": "tactsim.interfaces.variation:log_uniform",
    "material": "tactsim.materials.library:material",
    "normal": "tactsim.interfaces.variation:normal",
    "read_uniaxial_curve": "tactsim.identification.uniaxial_data:read_uniaxial_curve",
    "save_case": "tactsim.case.writing:save_case",
    "sweep": "tactsim.dataset.running.whole:sweep",
    "uniform": "tactsim.interfaces.variation:uniform",
}
"""Name -> module and name there."""

presented_by("tactsim.presentation")


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'tactsim' has no attribute {name!r}")
    import importlib

    from tactsim.outside.extras import extras_named

    module, _, attribute = _PLACES[name].partition(":")
    with extras_named():
        value = globals()[name] = getattr(importlib.import_module(module), attribute)
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
