"""Complex compliances: read in every allowed form, made up, and refused when they cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.atrial import table_4_1
from tactsim.errors import InvalidQuantity, StorageError
from tactsim.identification.dma_data import DmaData, parts_of, read_dma, synthetic_dma

FREQUENCIES = np.array([1.0, 2.0, 3.0])
COMPLIANCE = np.array([3 - 1j, 2 - 0.5j, 1 - 0.2j]) * 1e-5


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]", lambda E: (E.real / 1e3, E.imag / 1e3)),
        (
            "Frequency (Hz), Elastic_Compliance (1/MPa), viscous compliance [1/MPa]",
            lambda E: (1e6 * (1 / E).real, -1e6 * (1 / E).imag),
        ),
        ("frequency [Hz], dynamic modulus [MPa], phase [deg]", lambda E: (np.abs(E) / 1e6, np.degrees(np.angle(E)))),
    ],
)
def test_every_form_of_file_gives_the_same_compliance(tmp_path, header, columns):
    path = tmp_path / "dma.csv"
    rows = zip(FREQUENCIES, *columns(1 / COMPLIANCE), strict=True)
    path.write_text("# a test\n" + header + "\n" + "\n".join(",".join(repr(float(x)) for x in row) for row in rows))
    data = read_dma(path, 0.02)
    np.testing.assert_allclose(data.compliance, COMPLIANCE, rtol=1e-14)  # round-off
    np.testing.assert_allclose(data.modulus * data.compliance, 1, rtol=1e-14)
    assert data.relative_noise.shape == (2, 3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no header"),
        ("frequency [Hz], storage modulus, loss modulus [kPa]\n", "'storage modulus' has no unit; write it in brackets"),
        ("frequency [Hz], storage modulus [mm], loss modulus [kPa]\n", "wrong dimension"),
        ("frequency [Hz], stiffness [kPa], loss modulus [kPa]\n1,2,3\n", "unknown column 'stiffness"),
        ("frequency [Hz], storage modulus [kPa]\n1,2", "allowed: frequency with"),
        ("frequency [Hz], frequency [Hz], phase [deg]\n", "stands there 2 times"),
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,2\n", ":2: 2 values in a row of 3"),
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,nan,2\n", ":2: storage modulus is 'nan'"),
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,x,2\n", ":2: storage modulus is 'x'"),
        (
            "frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,2,3\n2,-2,3\n3,2,3",
            "storage modulus in row 2 is -2000 Pa",
        ),
        ("frequency [Hz], dynamic modulus [kPa], phase [deg]\n1,2,3\n2,2,95\n3,2,3", "phase in row 2"),
        (
            "frequency [Hz], elastic compliance [1/kPa], viscous compliance [1/kPa]\n1,2,3\n2,2,0\n3,2,3",
            "viscous compliance in row 2",
        ),
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,2,3\n3,2,3\n2,2,3", "row 3 is 2 Hz after 3 Hz"),
        ("frequency [Hz], storage modulus [kPa], loss modulus [kPa]\n1,2,3\n3,2,3", "at least 3"),
    ],
)
def test_a_bad_file_is_refused_with_the_place(tmp_path, text, words):
    path = tmp_path / "dma.csv"
    path.write_text(text)
    with pytest.raises(InvalidQuantity) as caught:
        read_dma(path)
    assert words in str(caught.value)
    assert "dma.csv" in str(caught.value)


def test_a_missing_file_is_a_storage_error(tmp_path):
    with pytest.raises(StorageError, match=r"none\.csv"):
        read_dma(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"frequencies": [1.0, 1.0, 2.0]}, "row 2 is 1 Hz after 1 Hz"),
        ({"frequencies": [np.nan, 1.0, 2.0]}, "row 1 is nan Hz"),
        ({"frequencies": [0.0, 1.0, 2.0]}, "row 1 is 0 Hz"),
        ({"frequencies": ["a", 1.0, 2.0]}, "real numbers"),
        ({"compliance": COMPLIANCE[:2]}, "one per frequency"),
        ({"compliance": ["x", 1, 2]}, "complex numbers"),
        ({"compliance": COMPLIANCE.conj()}, "viscous compliance in row 1"),
        ({"compliance": -COMPLIANCE}, "elastic compliance in row 1"),
        ({"compliance": COMPLIANCE * [1, np.nan, 1]}, "elastic compliance in row 2 is nan"),
        ({"relative_noise": -0.1}, "relative_noise is -0.1"),
        ({"relative_noise": [0.1, 0.2]}, "shape"),
        ({"relative_noise": [[0.1, 0.1, 0.1], [0.1, 0.0, 0.1]]}, "0 in places"),
    ],
)
def test_bad_numbers_are_refused(changes, words):
    with pytest.raises(InvalidQuantity) as caught:
        DmaData(**{"frequencies": FREQUENCIES, "compliance": COMPLIANCE, **changes})
    assert words in str(caught.value)


def test_synthetic_data_have_their_noise_and_their_seed():
    model, frequencies = table_4_1(), np.linspace(1, 36, 2000)
    data = synthetic_dma(model, frequencies, 0.02, 3)
    errors = data.parts / parts_of(model.complex_compliance(2 * np.pi * frequencies)) - 1
    assert errors.std() == pytest.approx(0.02, rel=0.06)  # 4000 numbers: five standard errors
    assert abs(np.corrcoef(errors)[0, 1]) < 0.1
    np.testing.assert_array_equal(data.compliance, synthetic_dma(model, frequencies, 0.02, 3).compliance)
    assert (data.compliance != synthetic_dma(model, frequencies, 0.02, 4).compliance).all()
    with pytest.raises(InvalidQuantity, match="noise"):
        synthetic_dma(model, noise=-0.1)
