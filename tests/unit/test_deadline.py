"""A computation ends once its time has passed, or once another thread stops it."""

import pytest

from tactsim.deadline import check_time, stopped_by, time_limit
from tactsim.errors import OutOfTime


def test_a_computation_is_stopped_when_it_is_asked_to_be():
    asked = []

    def stop() -> bool:
        asked.append(1)
        return len(asked) > 2

    with stopped_by(stop):
        check_time()
        check_time()
        with pytest.raises(OutOfTime, match="was stopped"):
            check_time()
    check_time()
    assert len(asked) == 3, "nobody asks after the computation"


def test_a_limit_holds_inside_only():
    with time_limit(-1.0), pytest.raises(OutOfTime, match="longer than"):
        check_time()
    check_time()
