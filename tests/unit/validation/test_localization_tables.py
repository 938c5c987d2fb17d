"""Pictures that are asked for what they do not have."""

from __future__ import annotations

import pytest

from tactsim.errors import InputError
from tactsim.validation.quantities.views import section_value


def test_a_pixel_beyond_the_picture_is_refused() -> None:
    with pytest.raises(InputError, match="pixel"):
        section_value(pixel=(6, 1))
