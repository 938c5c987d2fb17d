"""
Catheter tip: which of eight sensors sits on the mitral annulus?
================================================================

Eight small threshold sensors stand around the tip of a catheter. The annulus of the mitral valve is harder than the leaflet and
the atrium beside it, so the sensor with the highest threshold points to it. The stiffnesses are assumptions.
"""

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# The tip stands 11 mm from the middle of the valve and leans by two degrees; each sensor touches 200 times with fresh noise.
case = ts.load_case("catheter_tip")
result = case.run()
print(f"hardest at {result['hardest_angle'].to('deg'):.0f}, wrong in {result['chance_of_wrong'].value:.0%} of the touches")

# %%
# Neighbours on the same tissue read nearly the same, so the tip often names the wrong one of them, but never the wrong tissue.
# All reports lie above the true thresholds, because the touch is noticed late.
result.plot()["catheter_tip"]

# %%
# With less noise the two neighbours are told apart more often.
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
noises = (0.1, 0.3, 1.0, 2.0)
wrong = [
    ts.load_case("catheter_tip", {"experiment.sensor.chain.noise.white": f"{noise} mV", "experiment.trials": 60})
    .run()["chance_of_wrong"]
    .value
    for noise in noises
]
axis.plot(noises, wrong, marker="o")
axis.set(xscale="log", xlabel="white noise in mV", ylabel="share of touches that name\nthe wrong sensor", ylim=(0, None))
plt.show()
