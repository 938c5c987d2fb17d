"""
Calibration: from forces and voltages to a line with its intervals
==================================================================

A force sensor is loaded with known forces, and its voltages are read. What is the line between force and conductance, how sure is
it, and how far off is a reading?
"""

import tactsim as ts

# %%
# The shipped case reads a CSV file of 50 forces and voltages. These readings are synthetic; put your own in
# ``experiment.data.path``.
case = ts.load_case("calibrate_force_sensor")
result = case.run()

# %%
# Quantities that are intervals hold two numbers; ``to`` turns them into another unit like any other.
print("slope    ", result["slope"].to("mS/N"))
print("95 % from", result["slope_interval"].to("mS/N"))
print("noise    ", f"{result['noise'].to('mV'):.1f}")

# %%
# Above the readings and the line, below what it reads wrong. The largest errors are the linearity that a data sheet quotes.
result.plot("calibration")
