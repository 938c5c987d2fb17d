"""The pictures of the display: bands, sections and views, thesis section 6.3 and Appendix .1 and .2."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.interfaces import drawing, quantity
from tactsim.localization.bands import GREY_LEVELS, Form, band_image, band_intensities, element_positions, inserted_elements
from tactsim.localization.section_image import lump_rows, section_image
from tactsim.localization.views import SHAPE, Join, joined, pair_images, views
from tactsim.units import NonNegative, Positive
from tactsim.validation.curves import Data, Title

Place = Annotated[int, Field(ge=1)]
"""Counted from 1."""
ODD_SHAPE = (61, 101)
"""A picture whose middle column stands on the middle sensor."""
BORDERS = {"upper": 0, "lower": -1, "left": 0, "middle": 50, "right": -1}


@quantity(unit="1")
def band_level(signal: float, grey_levels: int = GREY_LEVELS) -> float:
    """Grey level, from 0 to K - 1, of eq. .1.1 for a signal over the normalising one.

    Parameters
    ----------
    signal : V over alpha
    grey_levels : K
    """
    return float(band_intensities(np.array(signal), 1.0, grey_levels))


@quantity(unit="1")
def band_number(
    number: Literal["inserted", "position", "value"],
    elements: Annotated[int, Field(ge=2)] = 7,
    pixels: Annotated[int, Field(ge=2)] = 60,
    at: Place = 1,
    form: Form = "corrected",
) -> float:
    """Elements inserted between two, position of an element from 1, or the value at a pixel when element j reads j.

    Parameters
    ----------
    number : which number
    elements : n
    pixels : N
    at : number of the element, or of the pixel, from 1
    form : eq. .1.4 corrected (E12) or as printed
    """
    if number == "inserted":
        return inserted_elements(elements, pixels)
    if number == "position":
        return float(element_positions(elements, pixels)[at - 1])
    return float(band_image(np.arange(1.0, elements + 1), pixels, form)[at - 1])


@quantity(unit="1")
def lump_row(upper: NonNegative[float], lower: NonNegative[float], rows: Place = SHAPE[0], form: Form = "corrected") -> float:
    """Row r of the picture, from 1 at the upper array, at which eq. .2.3 shows a lump for the signals of both arrays.

    Parameters
    ----------
    upper, lower : G_U and G_L
    rows : M
    form : corrected (E13, E25) or as printed
    """
    return float(lump_rows(np.array(upper), np.array(lower), rows, form))


@quantity(unit="1")
def section_value(
    upper: tuple[float, ...] = (3.0,),
    lower: tuple[float, ...] = (1.0,),
    shape: tuple[int, int] = (5, 1),
    pixel: tuple[Place, Place] = (1, 1),
    form: Form = "corrected",
) -> float:
    """Intensity H, in the unit of the signals, in a row and column of the picture between two arrays of Appendix .2.

    Parameters
    ----------
    upper, lower : V_U and V_L of each sensor
    shape : M and N
    pixel : row and column, from 1
    form : corrected (E12, E13, E25) or as printed

    Raises
    ------
    InputError
        If the picture has no such pixel.
    """
    if pixel[0] > shape[0] or pixel[1] > shape[1]:
        raise InputError(f"pixel {pixel} of a picture of {shape[0]} rows and {shape[1]} columns")
    return float(section_image(np.array(upper), np.array(lower), shape, form)[pixel[0] - 1, pixel[1] - 1])


@quantity(unit="1")
def top_view_rows(join: Join = "shared_once", rows: Place = SHAPE[0], sensors: Place = 3) -> float:
    """Number of rows of the top view once the pictures of all pairs of rows are joined.

    Parameters
    ----------
    join : how they are joined (E24)
    rows : M of each picture
    sensors : rows of each matrix
    """
    return float(len(joined(pair_images(np.ones((sensors, 3)), (rows, SHAPE[1])), join)))


@quantity(unit="1")
def view_output(
    view: Literal["front", "left", "top"], row: Literal["upper", "lower"], column: Literal["left", "middle", "right"]
) -> float:
    """Sum of the sensors at the border of a view of two 3 x 3 matrices.

    The upper sensor of row r and column c reads 10 r + c, the lower 100 more, so that the sum says which sensors it adds up.

    Parameters
    ----------
    view : which of the three
    row : border of the picture
    column : sensor along it, as in thesis Fig. 6.3
    """
    number = np.arange(1.0, 4.0)
    upper = 10 * number[:, None] + number
    image = getattr(views(np.array([upper, upper + 100]), ODD_SHAPE), view)
    return float(image[BORDERS[row], BORDERS[column]])


@drawing
def band_pictures(
    title: Title,
    signals: Annotated[tuple[NonNegative[float], ...], Field(min_length=2)],
    pixels: Annotated[tuple[int, ...], Field(min_length=1)] = (7, 60, 100),
    normalising: Positive[float] = 1.0,
) -> Data:
    """Form ``images``: the one-dimensional pictures of Appendix .1, the grey levels 0 to 255 of eqs. .1.1 and .1.4.

    Parameters
    ----------
    signals : outputs V of the elements, from left to right
    pixels : numbers N of pixels, one picture each
    normalising : alpha

    Raises
    ------
    InvalidQuantity
        If there are fewer pixels than elements.
    """
    grey = band_intensities(np.array(signals), normalising)
    panels = [
        {"title": f"{len(signals)} elements in {count} pixels", "grey": band_image(grey, count).tolist()} for count in pixels
    ]
    return {"form": "images", "title": title, "axis": "pixel", "panels": panels}


@drawing
def section_pictures(
    title: Title,
    upper: Annotated[tuple[NonNegative[float], ...], Field(min_length=2)],
    lower: Annotated[tuple[NonNegative[float], ...], Field(min_length=2)],
    shapes: tuple[tuple[Place, Place], ...] = ((7, 7), (60, 100)),
) -> Data:
    """Form ``images``: the section of Appendix .2 with the lump at its row, in several numbers of rows and columns.

    Parameters
    ----------
    upper, lower : outputs of the elements of both arrays, from left to right
    shapes : rows and columns of each picture

    Raises
    ------
    InvalidQuantity
        If a picture has fewer columns than the arrays have elements.
    """
    pictures = [section_image(np.array(upper), np.array(lower), shape) for shape in shapes]
    brightest = max(float(picture.max()) for picture in pictures)
    panels = [
        {
            "title": f"{shape[0]} × {shape[1]} pixels; white is the largest intensity",
            "grey": band_intensities(picture, brightest).tolist(),
        }
        for shape, picture in zip(shapes, pictures, strict=True)
    ]
    return {"form": "images", "title": title, "axis": "column", "panels": panels}
