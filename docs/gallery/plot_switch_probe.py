"""
Switch probe: hardness and rate from five switches
==================================================

A tapered probe is pushed into tissue. Along its side sit five switches that close one after the other; a force sensor at the tip
reads the force. Force at each switch tells how hard the tissue is at that rate, the times between them tell the rate.
"""

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# One tissue that relaxes by 90 % within seconds, at five rates. As in the thesis, the tissue is taken to follow the side of the
# probe; finite elements say that it does so only in part (``cases/switch_probe_fem.yaml``).
result = ts.load_case("switch_rates").run()

# %%
# The faster the push, the harder the tissue seems.
figures = result.plot()
figures["force_over_depth"]

# %%
# What the probe itself knows at the slowest rate: five forces with their times.
figures["switch_panel"]

# %%
# The mean rate that the probe reports from its switches, against the rate of the hand:
rates = [1e3 * rate for rate in result.experiment.rates]
reported = [result[f"mean_rate_{number}"].to("mm/s").value for number in range(1, len(rates) + 1)]
figure, axis = plt.subplots(figsize=(4.5, 3.5), layout="constrained")
axis.plot([0, 3.2], [0, 3.2], color="0.7", linewidth=1)
axis.plot(rates, reported, "o")
axis.set(xlabel="rate of the hand in mm/s", ylabel="rate from the switches in mm/s")
plt.show()
