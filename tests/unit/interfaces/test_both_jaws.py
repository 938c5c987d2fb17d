"""What a result holds of both jaws, with a history and without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from live_pages import made_up_grasp, taxel_forces

from tactsim.errors import InputError, StorageError, UnknownName
from tactsim.experiments.grasp.matrix_readout import MatrixReadoutRun
from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, has_taxels, jaws_at_end, jaws_over_time, over_time
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results import Quantity
from tactsim.results.result import StepRecord
from tactsim.results.writing import write_result


@pytest.mark.parametrize("steps", [1, 4])
def test_steps_come_first_and_then_jaws_with_the_upper_one_before(steps: int) -> None:
    forces = taxel_forces(steps)
    result = made_up_grasp(forces)
    assert has_taxels(result, TAXEL_FORCE)
    assert has_taxels(result, TAXEL_FORCE, history=True) == (steps > 1)
    assert not has_taxels(result, READ_FORCE)
    np.testing.assert_array_equal(jaws_over_time(result, TAXEL_FORCE), forces)
    np.testing.assert_array_equal(jaws_at_end(result, TAXEL_FORCE), forces[-1])
    np.testing.assert_allclose(over_time(result, "displacement"), np.linspace(1e-3 / steps, 1e-3, steps), rtol=1e-12)


@pytest.mark.parametrize("value", ["x", [[1.0, 2.0], [3.0]], [[1.0]], None])
def test_what_no_run_writes_is_refused_in_words(value: object) -> None:
    result = made_up_grasp(taxel_forces(1))
    lower = {f"{TAXEL_FORCE}_{JAWS[1]}": Quantity(value, "N", "")}
    for read in (jaws_at_end, jaws_over_time):
        with pytest.raises(InputError, match="taxel_force of both jaws are not numbers in matrices of one shape"):
            read(replace(result, quantities=result.quantities | lower), TAXEL_FORCE)
        with pytest.raises(InputError, match="read_force of both jaws"):
            read(result, READ_FORCE)
    with pytest.raises(UnknownName, match="'gap'"):
        over_time(result, "gap")


@pytest.mark.parametrize("missing", ["time_history", "taxel_force_lower_history", "taxel_force"])
def test_a_stored_grasp_with_a_part_missing_is_not_read_through_sensors(tmp_path, missing: str) -> None:
    result = made_up_grasp()
    steps = tuple(StepRecord(k, 1, 0.0, {"displacement": 0.25e-3 * k}) for k in range(1, 5))
    whole = result.quantities | {f"taxel_pressure_{side}": result.quantities[f"taxel_force_{side}"] for side in JAWS}
    part = {name: quantity for name, quantity in whole.items() if not name.startswith(missing)}
    for place, quantities in (("whole", whole), ("part", part)):
        write_result(replace(result, steps=steps, quantities=quantities), tmp_path / place, case_id="0" * 16, provenance={})
    assert len(MatrixReadoutRun(grasp=str(tmp_path / "whole")).run().steps) > 4
    with pytest.raises(StorageError, match="not a complete result of a grasp"):
        MatrixReadoutRun(grasp=str(tmp_path / "part")).run()
