"""Creep of a film: its coefficients come back, their intervals cover them, and wrong data are refused."""

import numpy as np
import pytest

from tactsim.errors import InvalidQuantity, StorageError
from tactsim.identification.film_creep import CreepTest, coefficient_lines, fit_creep, read_creep, synthetic_creep
from tactsim.sensors.films.composite import CREEP_COEFFICIENTS
from tactsim.sensors.films.composite_library import named_composite

LINGSTAT = named_composite("lingstat_literal")
AREA = LINGSTAT.reference_area
FORCES = (2.0, 4.0, 6.0, 8.0)
TIMES = np.linspace(0, 30, 200)


def noisy_creep(noise, seed=1):
    return synthetic_creep(LINGSTAT, FORCES, TIMES, noise=noise, generator=np.random.default_rng(seed))


def test_the_lines_of_2_3_1_come_back_from_clean_creep():
    lines = coefficient_lines([fit_creep(test, AREA) for test in noisy_creep(0.0)])
    for name in CREEP_COEFFICIENTS:
        true = getattr(LINGSTAT, name)
        assert lines[name].slope == pytest.approx(true.slope, rel=1e-6)
        assert lines[name].intercept == pytest.approx(true.intercept, rel=1e-6)


def test_a_first_sample_before_the_load_leaves_the_least_squares():
    """A record may begin with a zero from before the load: the coefficients are the best ones for all samples all the same."""
    test = noisy_creep(0.0)[0]
    late = CreepTest(test.force, TIMES, np.append(0.0, test.strain[1:]))
    fit, true = fit_creep(late, AREA), fit_creep(test, AREA)
    missed_by_true = late.strain - (test.strain - true.residuals)
    assert (fit.residuals**2).sum() < (missed_by_true**2).sum()
    assert fit.half_widths[0] > true.half_widths[0]


def covered(noise, claimed):
    """Share of 200 seeded tests whose interval, scaled by ``claimed``, holds the true coefficients."""
    true = np.array([getattr(LINGSTAT, name).at(4.0) for name in CREEP_COEFFICIENTS])
    inside = []
    for seed in range(200):
        fit = fit_creep(synthetic_creep(LINGSTAT, (4.0,), TIMES, noise=noise, generator=np.random.default_rng(seed))[0], AREA)
        inside.append(np.abs(fit.coefficients - true) <= claimed * fit.half_widths)
    return np.mean(inside, axis=0)


def test_intervals_cover_the_coefficients():
    share = covered(0.005, 1.0)
    assert np.all((share >= 0.895) & (share <= 0.99))
    assert not np.all(covered(0.005, 0.5) >= 0.895)


@pytest.mark.parametrize(
    ("test", "message"),
    [
        (CreepTest(2.0, TIMES[:5], TIMES[:5] + 1), "at least 6"),
        (CreepTest(0.0, TIMES, TIMES + 1), "> 0"),
        (CreepTest(2.0, TIMES[::-1], TIMES + 1), "increase"),
        (CreepTest(2.0, TIMES, np.full(200, np.nan)), "finite"),
        (CreepTest(2.0, TIMES, np.full(200, -0.01)), "compressive strain is positive"),
    ],
)
def test_bad_creep_is_refused(test, message):
    with pytest.raises(InvalidQuantity, match=message):
        fit_creep(test, AREA)


def test_two_forces_give_no_line():
    with pytest.raises(InvalidQuantity, match="at least 3"):
        coefficient_lines([fit_creep(test, AREA) for test in noisy_creep(0.0)[:2]])


def test_a_file_is_read_in_its_units(tmp_path):
    rows = [f"{t * 1e3},{test.force},{s}" for test in noisy_creep(0.001) for t, s in zip(test.time, test.strain, strict=True)]
    path = tmp_path / "creep.csv"
    path.write_text("\n".join(["time [ms], force [N], strain [1]", *rows]), encoding="utf-8")
    read = read_creep(path)
    assert [test.force for test in read] == list(FORCES)
    np.testing.assert_allclose(read[0].time, TIMES, atol=1e-12)
    path.write_text("time [s], force [N]\n0, 1\n", encoding="utf-8")
    with pytest.raises(InvalidQuantity, match="no column strain"):
        read_creep(path)
    with pytest.raises(StorageError):
        read_creep(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t, force, s: (t, force * (1 + 1e-4 * t), s), r"stands in 1 rows.*write the force that was set"),
        (lambda t, force, s: (t, force, -s), "at 2 N never strains"),
        (lambda t, force, s: (t, force, 100 * s), r"at 2 N strains by up to 1\..*below 1.*in percent"),
        (lambda t, force, s: (t, 0 * force, s), "under a force of 0 N"),
        (lambda t, force, s: (t % 10, force, s), "must increase from 0 s or later: one test for each force"),
    ],
)
def test_what_is_wrong_in_a_file_is_refused_with_its_name(tmp_path, change, message):
    test = noisy_creep(0.001)[0]
    rows = [change(t, test.force, s) for t, s in zip(test.time, test.strain, strict=True)]
    path = tmp_path / "creep.csv"
    np.savetxt(path, rows, delimiter=",", header="time [s], force [N], strain [1]", comments="", fmt="%.17g")
    with pytest.raises(InvalidQuantity, match=r"creep\.csv: .*" + message):
        read_creep(path)
