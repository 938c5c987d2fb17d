"""Measured curves from CSV: columns, units, and what is refused with file and line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tactsim.errors import InvalidQuantity, StorageError
from tactsim.identification.uniaxial_certainty import wrong_signs
from tactsim.identification.uniaxial_data import UniaxialCurve, read_uniaxial_curve


@pytest.fixture
def read(tmp_path: Path):
    """The curve of a text."""

    def read_text(text: str | bytes) -> UniaxialCurve:
        path = tmp_path / "curve.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_uniaxial_curve(path)

    return read_text


ROWS = "0.7,-3\n0.8,-2\n0.9,-1\n"


@pytest.mark.parametrize(
    "column",
    [
        "nominal_stress_kPa",
        "nominal_stress (kPa)",
        "nominal_stress [kPa]",
        "engineering_stress_kPa",
        "nominal stress [kPa]",
        "Engineering Stress [kPa]",
        "Stress (kPa)",
        "stress_kPa",
    ],
)
def test_the_unit_is_in_the_header(read, column):
    curve = read(f"stretch,{column}\n{ROWS}")
    np.testing.assert_allclose(curve.stretch, [0.7, 0.8, 0.9])
    np.testing.assert_allclose(curve.nominal_stress, [-3e3, -2e3, -1e3])
    assert curve.source.endswith("curve.csv")


@pytest.mark.parametrize("unit", ["N/mm^2", "MPa"])
def test_units_are_converted(read, unit):
    np.testing.assert_allclose(read(f"stretch,nominal_stress ({unit})\n{ROWS}").nominal_stress, [-3e6, -2e6, -1e6])


@pytest.mark.parametrize(
    ("column", "factor"),
    [
        ("strain", 1),
        ("engineering_strain", 1),
        ("strain_%", 100),
        ("strain (percent)", 100),
        ("Strain (%)", 100),
        ("strain [%]", 100),
        ("Engineering Strain [-]", 1),
    ],
)
def test_strain_is_stretch_less_one(read, column, factor):
    rows = "".join(f"{-x * factor:g},{-x}\n" for x in (0.3, 0.2, 0.1))
    np.testing.assert_allclose(read(f"{column},nominal_stress_Pa\n{rows}").stretch, [0.7, 0.8, 0.9], rtol=1e-15)


@pytest.mark.parametrize("column", ["true_stress", "cauchy_stress"])
def test_true_stress_is_divided_by_the_stretch(read, column):
    np.testing.assert_allclose(read(f"stretch,{column}_Pa\n{ROWS}").nominal_stress, [-3 / 0.7, -2 / 0.8, -1 / 0.9])


def test_order_comments_blank_lines_other_columns_and_byte_order_mark(read):
    text = "\ufeff# rubber, batch 3\n\ntime_s,stretch,nominal_stress_Pa\n0,0.9,-1\n# pause\n1, 0.7 ,-3\n\n2,0.8,-2\n"
    curve = read(text)
    np.testing.assert_array_equal(curve.stretch, [0.7, 0.8, 0.9])
    np.testing.assert_array_equal(curve.nominal_stress, [-3, -2, -1])


HEADER = "stretch,nominal_stress_kPa\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no header and no data"),
        ("# only a comment\n", "no header and no data"),
        (HEADER, "at least 3 different stretches"),
        (HEADER + "0.7,-3\n0.8,-2\n", "at least 3 different stretches"),
        (HEADER + "0.7,-3\n0.7,-3\n0.7,-3\n1,0\n", "at least 3 different stretches"),
        (HEADER + "0.7,nan\n0.8,-2\n0.9,-1\n", r"curve\.csv:2: column 2 is 'nan'; allowed: a finite number"),
        (HEADER + "0.7,-3\n0.8,inf\n0.9,-1\n", r"curve\.csv:3: column 2 is 'inf'"),
        (HEADER + "0.7,-3\n0.8,two\n0.9,-1\n", r"curve\.csv:3: column 2 is 'two'"),
        (HEADER + "0.7,-3\n0.8,\n0.9,-1\n", r"curve\.csv:3: column 2 is ''"),
        (HEADER + "0.7,-3\n0.8,-2,5\n0.9,-1\n", r"curve\.csv:3: 3 values in a row of 2 columns"),
        ("stretch,nominal_stress\n" + ROWS, "'nominal_stress' has no unit; write it after the name, like nominal_stress_kPa"),
        ("stretch,nominal_stress_mm\n" + ROWS, "'nominal_stress': '1 mm' has the wrong dimension"),
        ("stretch,nominal_stress_kPb\n" + ROWS, "unknown unit 'kPb'"),
        ("lambda,nominal_stress_kPa\n" + ROWS, "'lambda, nominal_stress_kPa' must have exactly one column of stretch, strain"),
        ("stretch,force_N\n" + ROWS, "exactly one column of stress, nominal_stress"),
        ("stretch,strain,nominal_stress_kPa\n0.7,-0.3,-3\n", "exactly one column of stretch"),
        ("stretch_mm,nominal_stress_kPa\n" + ROWS, "column 'stretch' has the unit 'mm': stretch and strain are dimensionless"),
        (HEADER + "-30,-3\n-20,-2\n-10,-1\n", "stretch = -30; it must be > 0"),
        (HEADER + "0.7,3\n0.8,2\n0.9,1\n", "tension positive, compression negative"),
        (HEADER + "0.7,0\n0.8,0\n0.9,0\n", "tension positive, compression negative"),
    ],
)
def test_what_is_no_curve_is_reported(read, text, words):
    with pytest.raises(InvalidQuantity, match=words):
        read(text)


def test_files_that_cannot_be_read(read, tmp_path):
    with pytest.raises(StorageError, match=r"missing\.csv"):
        read_uniaxial_curve(tmp_path / "missing.csv")
    with pytest.raises(StorageError, match="byte 0xff at 27 is not UTF-8 text"):
        read(b"stretch,nominal_stress_kPa\n\xff\xfe")
    with pytest.raises(StorageError):
        read_uniaxial_curve(tmp_path)


@pytest.mark.parametrize(
    ("stretch", "stress", "words"),
    [
        ([0.7, 0.8, 0.9], [-3, -2], "3 stretches but 2 stresses"),
        ([0.7, 0.8, np.nan], [-3, -2, -1], "not finite"),
        ([0.7, 0.8, 0.0], [-3, -2, -1], "stretch = 0"),
    ],
)
def test_a_curve_checks_itself(stretch, stress, words):
    with pytest.raises(InvalidQuantity, match=rf"here: .*{words}"):
        UniaxialCurve(np.array(stretch), np.array(stress), "here")


def test_a_curve_is_a_copy_sorted_by_stretch():
    stretch = np.array([0.9, 0.7, 0.8])
    curve = UniaxialCurve(stretch, np.array([-1.0, -3, -2]), "here")
    np.testing.assert_array_equal(stretch, [0.9, 0.7, 0.8])
    np.testing.assert_array_equal(curve.nominal_stress, [-3, -2, -1])


MACHINE = """Specimen Width (mm);6;;;
Standard;ASTM D412;;;
;;;;
Time (s);True Strain;True Stress (MPa);Engineering Strain;Engineering Stress (MPa)
0,2;0,0436;-0,00098;0,0446;-0,00094
0,8;0,1670;0,01101;0,1818;0,009315
1,4;0,2762;0,02008;0,3181;0,01524
2,0;0,3746;0,03110;0,4545;0,021385
"""


@pytest.mark.parametrize("decimal", [",", "."])
def test_the_file_of_a_testing_machine_is_read_as_it_is(decimal, tmp_path):
    """Lines above the header, semicolons, decimal commas, true values beside nominal ones."""
    path = tmp_path / "machine.csv"
    path.write_text(MACHINE.replace(",", decimal), encoding="utf-8")
    curve = read_uniaxial_curve(path)
    np.testing.assert_allclose(curve.stretch, [1.0446, 1.1818, 1.3181, 1.4545], rtol=1e-12)
    np.testing.assert_allclose(curve.nominal_stress, [-940, 9315, 15240, 21385], rtol=1e-12)
    [words] = wrong_signs(curve)
    assert "1 of 4 points have a stress against their strain, such as -940 Pa at a strain of 0.0446" in words
    part = curve.within(0.1, 1)
    assert part.stretch.size == 3
    assert wrong_signs(part) == ()
    with pytest.raises(InvalidQuantity, match="at least 3"):
        curve.within(0.3, 1)
    with pytest.raises(InvalidQuantity, match="from the lower one"):
        curve.within(1, 0.1)


def test_a_decimal_comma_among_commas_is_refused(tmp_path):
    path = tmp_path / "comma.csv"
    path.write_text("stretch,nominal_stress_kPa\n0,7,-3\n", encoding="utf-8")
    with pytest.raises(InvalidQuantity, match="3 values in a row of 2 columns"):
        read_uniaxial_curve(path)
