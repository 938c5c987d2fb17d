"""
Your own readings as a tactile image
====================================

Two arrays of sensors face each other across a piece of tissue. Their readings become two bands of grey levels, and the section
between them, in which a lump stands nearer to the array that reads more.
"""

import tactsim as ts

# %%
# The shipped case reads a CSV file with the columns ``upper [N]`` and ``lower [N]``, a row for each element; put your own in
# ``experiment.readings.path``. One array alone needs no ``lower [N]``, and has no section.
case = ts.load_case("tactile_bands")
result = case.run()

# %%
# Where each column of the section shows a lump, as a part of the thickness below the upper array.
print(result["depth_share"].numbers.round(2))

# %%
# The elements as they read, interpolated over the pixels, and the section between both arrays.
result.plot("bands")
