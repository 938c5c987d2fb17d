"""Every registered estimator and each of its variants on readings made by the fast forward model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, NOISE, SIZE, plain_forces, response

from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.any_estimator import offered_estimators
from tactsim.registry import kinds

KINDS, OFFERED = kinds(Estimator), offered_estimators()
CENTER, RADIUS, CONTRAST = np.array([18e-3, 22e-3, 12e-3]), 4e-3, 10.0


@pytest.fixture(scope="module")
def readings() -> Readings:
    """A ball in plain tissue, without noise beyond what is stated."""
    table = response()
    plain = plain_forces(np.array([1e-3]))[0]
    forces = plain + CONTRAST * table.signal(CENTER[None], np.array([RADIUS]))[0]
    return Readings(forces, LAYOUT, SIZE, reference=plain, noise=NOISE, closing=1e-3, response=table)


@pytest.mark.parametrize("name", OFFERED)
def test_what_is_found_lies_in_the_block_and_is_finite(name: str, readings: Readings) -> None:
    estimate = OFFERED[name].estimate(readings)
    assert estimate.present
    assert estimate.reason
    for one in estimate.inclusions:
        center = np.array(one.center)
        assert ((center >= 0) & (center <= SIZE)).all()
        assert one.radius is None or 0 < one.radius < SIZE.min()
        if one.covariance is not None:
            assert np.linalg.eigvalsh(one.covariance).min() >= -1e-15
        if one.region is not None:
            assert all(0 < size < 2 * SIZE.max() for size in one.region.sizes())
            assert one.region.contains(center)
            assert not one.region.contains(center + 2 * SIZE.max())
            assert all(np.isfinite(line).all() for away in range(3) for line in one.region.shadow(away))
    assert estimate.probability is None or estimate.probability > 0.5
    assert (estimate.classes is not None) == OFFERED[name].gives_classes


@pytest.mark.parametrize("name", [name for name, one in OFFERED.items() if one.needs_reference])
def test_the_ball_is_found_where_it_is_and_nothing_where_nothing_is(name: str, readings: Readings) -> None:
    strongest = OFFERED[name].estimate(readings).inclusions[0]
    assert np.abs(np.array(strongest.center)[:2] - CENTER[:2]).max() < LAYOUT.pitch / 2
    plain = replace(readings, forces=np.asarray(readings.reference))
    assert not OFFERED[name].estimate(plain).present


@pytest.mark.parametrize("name", OFFERED)
def test_what_is_missing_is_refused(name: str, readings: Readings) -> None:
    estimator = OFFERED[name]
    bare = replace(readings, reference=None, response=None)
    if estimator.needs_reference:
        with pytest.raises(InputError, match="reference"):
            estimator.estimate(bare)
    else:
        assert estimator.estimate(bare).reason
    if estimator.needs_response:
        with pytest.raises(InputError, match="response"):
            estimator.estimate(replace(readings, response=None))


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_it_is_offered_or_needs_a_file(kind: str) -> None:
    cls = KINDS[kind]
    assert cls.example().kind == kind
    assert cls.example().title
    variants = cls.variants()
    assert set(variants) <= set(OFFERED)
    assert variants or any("path" in str(field) or "weights" in name for name, field in cls.model_fields.items())
    assert type(cls.example()).model_validate(cls.example().model_dump()) == cls.example()
