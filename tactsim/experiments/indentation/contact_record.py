"""What every simulation of contact reports of a state: forces, heights, fields, and what was assumed."""

from __future__ import annotations

import numpy as np

from tactsim.experiments.indentation.contact_setup import ContactSetup
from tactsim.fem.body import PastStress
from tactsim.fem.material_forms import interpreted_warnings
from tactsim.fem.memory import mean_stress
from tactsim.interfaces import RigidBody
from tactsim.materials.stability import principal_stretches
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.ellipticity import elliptic_in
from tactsim.mechanics.plausibility import oddities
from tactsim.mechanics.section_model import IndentationModel
from tactsim.results.result import FieldFrame
from tactsim.units import format_quantity

Array = np.ndarray


def contact_values(
    model: IndentationModel, state: ContactEquilibrium, past: PastStress | None = None
) -> tuple[dict[str, float], list[float]]:
    """History values of a state in SI, and the force in N on each body; ``past`` is what relaxing materials remembered."""
    displacement = model.displacement(state.unknowns)
    tractions = [contact.at(displacement) for contact in state.contacts]
    forces = [-float(model.surface.total(t.traction)[1]) for t in tractions]
    values = {
        "displacement": state.load,
        "reaction_force": forces[0],
        "base_force": float(model.base_force(state.unknowns, past)[1]),
        "max_penetration": max(0.0, *(float(-t.gap.min()) for t in tractions)),
        "max_pressure": max(float(t.pressure.max()) for t in tractions),
        "min_volume_ratio": float(state.kinematics.J.min()),
    }
    return values, forces


def tissue_rise(
    model: IndentationModel, state: ContactEquilibrium, body: RigidBody, starting_height: float
) -> tuple[float, float]:
    """Largest height of the tissue in the hole above the annulus's face, and the height on the axis, in m.

    ``starting_height`` in m of the body's reference point at first touch.
    """
    face = starting_height - state.load
    highest, axis = model.highest(state.unknowns, body.inner_radius)  # type: ignore[attr-defined]
    return highest - face, axis - face


def elliptic_points(model: IndentationModel, state: ContactEquilibrium) -> Array:
    """Whether the material is strongly elliptic at each point (E, Q)."""
    return elliptic_in(model.body, state.kinematics)


def section_frame(
    model: IndentationModel, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None
) -> FieldFrame:
    """Fields of a state for ParaView; ``time`` stands in the index.

    ``isochoric`` (6, E, Q) is the relaxed isochoric stress in Pa, whose trace in the deformed state counts to the pressure.
    """
    space, mesh = model.space, model.mesh
    u, p = space.split(state.unknowns)
    flat = np.zeros((len(u), 3))
    points, displacement = flat.copy(), flat.copy()
    points[:, :2], displacement[:, :2] = mesh.nodes, u
    pressure = np.zeros(len(u))
    pressure[: len(p)] = -p
    if isochoric is not None:
        pressure[: len(p)] -= _at_corners(model, mean_stress(model.body, state.kinematics, isochoric))
    ends = mesh.elements[:, [[0, 1], [1, 2], [0, 2]]]
    pressure[mesh.elements[:, 3:]] = pressure[ends].mean(axis=2)
    stretch = principal_stretches(state.kinematics.F)[0]
    return FieldFrame(
        time=time,
        points=points,
        cells={"triangle6": mesh.elements},
        point_data={"displacement [m]": displacement, "pressure [Pa]": pressure},
        cell_data={
            "largest_stretch [1]": stretch.max(axis=1),
            "volume_ratio [1]": state.kinematics.J.mean(axis=1),
            "region [1]": mesh.regions.astype(float),
            "elliptic [1]": elliptic_points(model, state).all(axis=1).astype(float),
        },
    )


def _at_corners(model: IndentationModel, values: Array) -> Array:
    """Values (E, Q) at the volume points as means over the elements around each corner node, by volume."""
    weights, corners = model.body.points.weights, model.mesh.elements[:, :3]
    volume = np.repeat(weights.sum(axis=1), 3)
    total = np.repeat((weights * values).sum(axis=1), 3)
    return np.bincount(corners.ravel(), total) / np.bincount(corners.ravel(), volume)


def contact_oddities(experiment: ContactSetup) -> list[str]:
    """What in the case looks like a wrong unit."""
    specimen, body = experiment.specimen, experiment.body
    layers = {f"specimen.layers.{k}": layer for k, layer in enumerate(specimen.layers)}
    materials = {f"{name}.material": layer.material for name, layer in layers.items()} | {"specimen.material": specimen.material}
    tissue = {"specimen.thickness": specimen.thickness, "specimen.radius": specimen.radius}
    tissue |= {f"{name}.thickness": layer.thickness for name, layer in layers.items()}
    bodies = {f"body.{name}": getattr(body, name) for name in ("radius", "inner_radius", "outer_radius") if hasattr(body, name)}
    return [*oddities(materials, tissue=tissue, bodies=bodies), *interpreted_warnings(materials)]


def contact_assumptions(experiment: ContactSetup) -> list[str]:
    """What the thesis does not print and the case chose."""
    specimen = experiment.specimen
    radius, thickness = format_quantity(specimen.radius, "m"), format_quantity(specimen.thickness, "m")
    told = [f"specimen of radius {radius} and thickness {thickness} on a {specimen.base} base (the thesis prints no size)"]
    if hasattr(experiment.body, "fillet"):
        told.append(f"edges of the body filleted by {format_quantity(experiment.body.fillet, 'm')} (not printed)")
    if any(material.bulk_modulus is None for material in specimen.materials):
        told.append("exactly incompressible tissue (the thesis prints no bulk modulus)")
    told.append(f"penetration below {format_quantity(experiment.tolerance, 'm')}, elastic slip below ten times that")
    return told
