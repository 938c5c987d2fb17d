"""What trials of a threshold sensor and the tip of a catheter report beside quantities and history."""

from __future__ import annotations

from typing import Literal

from tactsim.model import FrozenModel
from tactsim.results.scene import Scene
from tactsim.sensors.threshold.sensor_ring import SensorRing


class ThresholdCapture(FrozenModel):
    """One touch and the threshold that was captured in it."""

    touch_time: float
    """When the tissue touches the small sensor, in s."""
    threshold_force: float
    """True threshold in N."""
    armed_time: float
    """When the trigger is armed, in s."""
    trigger_level: float
    """Reading of the small sensor in N that triggers."""
    speed: float
    """In m/s."""
    noise: float
    """Root mean square of the white noise in V."""
    cutoff: float
    """Of the low pass, in Hz."""
    large_bears: Literal["plate_and_small", "plate"]
    """What presses the large sensor."""
    capture: Literal["filtered", "unfiltered"]
    """Which reading of the large sensor is captured."""
    trigger_time: float | None = None
    """In s; null if nothing triggered."""
    captured_force: float | None = None
    """Reported threshold in N; null if nothing triggered."""


class ThresholdTrialScene(Scene):
    """Axes of the trials, and the touch that is drawn."""

    kind: Literal["threshold_trial"] = "threshold_trial"
    speeds: tuple[float, ...]
    """In m/s."""
    noises: tuple[float, ...]
    """Root mean squares in V."""
    cutoffs: tuple[float, ...]
    """In Hz."""
    complete: bool
    """Whether every combination was tried."""
    capture: ThresholdCapture | None = None
    """Null before the first touch was recorded."""


class CatheterTipScene(Scene):
    """The tip on the surface; lengths in m."""

    kind: Literal["catheter_tip"] = "catheter_tip"
    tissues: tuple[str, ...]
    """Names of the tissues from the middle outward."""
    borders: tuple[float, ...]
    """Radii of the borders between them."""
    ring: SensorRing
    """The sensors."""
    place: tuple[float, float]
    """Middle of the tip."""
    state: tuple[str, ...]
    """Of every sensor, in words."""
    straddles: tuple[bool, ...]
    """Whether each sensor lies over two tissues."""
    area: float
    """Of the face of a sensor in m^2."""
