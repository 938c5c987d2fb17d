"""
Matrix readout: forces of a grasp as voltages
=============================================

A grasp gives forces. What arrives at the computer are voltages: of films that creep, differ from each other, and pick up noise.
``matrix_readout`` reads a stored grasp through film and electronics without solving it again.
"""

import matplotlib.pyplot as plt
import numpy as np

import tactsim as ts

# %%
# The grasp is the one of :doc:`plot_grasp`. Every sensor has the film, a divider, white noise and hum, and a converter of 16
# bits; their gains scatter by 2.5 %.
readout = ts.kinds("experiment")["matrix_readout"](
    grasp="stored/grasp_lump",
    readout={
        "film": {"composite": "lingstat_identified"},
        "chain": {
            "sampling_rate": "200 Hz",
            "noise": {"white": "0.2 mV", "line": "0.5 mV"},
            "converter": {"low": "-5 V", "high": "5 V", "bits": 16},
            "low_pass": {"cutoff": "40 Hz", "order": 1},
        },
        "scatter": {"repeatability": 0.025, "full_scale": "20 N", "seed": 1},
        "seed": 1,
    },
)
result = readout.run()

# %%
# Voltages of all eighteen sensors while the jaws close:
result.plot("taxel_voltages")

# %%
# And the forces that a calibrated line makes of the last voltages, against the forces that acted. The line reads too little at
# such small forces, where the film does not follow it (see :doc:`plot_film_test`); the order of the sensors stays.
grasp = ts.load_result("stored/grasp_lump")
figure, axis = plt.subplots(figsize=(4.2, 4), layout="constrained")
for jaw, marker in (("upper", "^"), ("lower", "v")):
    acted = grasp[f"taxel_force_{jaw}"].to("mN").numbers
    read = result[f"read_force_{jaw}"].to("mN").numbers
    axis.plot(np.ravel(acted), np.ravel(read), marker, label=f"{jaw} jaw")
axis.plot([150, 400], [150, 400], color="0.6", linewidth=1)
axis.set(xlabel="force that acts in mN", ylabel="force that is read in mN")
axis.legend(frameon=False)
plt.show()
