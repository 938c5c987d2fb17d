"""
Threshold trial: how exact is the threshold that the electronics report?
========================================================================

The threshold is the force on the ring when the inner sensor is touched. The electronics notice the touch only when the inner
sensor's reading rises out of the noise, and by then the force has grown. How much, over speed, noise and cut-off?
"""

import tactsim as ts

# %%
# The forces come from a simulation that goes on past the touch. Two speeds, two noises and three cut-offs make a small trial; the
# shipped case has 75 combinations.
case = ts.load_case(
    "threshold_trial",
    {
        "experiment.speeds": ["1 mm/s", "5 mm/s"],
        "experiment.noises": ["0.1 mV", "0.5 mV"],
        "experiment.cutoffs": ["5 Hz", "20 Hz", "100 Hz"],
        "experiment.trials": 20,
    },
)
result = case.run()
print("true threshold:", f"{result['threshold_force'].numbers[0]:.3f} N")

# %%
# The error is mostly the level of the trigger: the touch must push the reading above six times the noise. A lower cut-off has
# less noise and a lower level, at the price of lag, which counts at higher speed.
figures = result.plot()
figures["threshold_errors"]

# %%
# One touch: above the ring, below the inner sensor, which crosses the trigger some time after the tissue has touched it.
figures["threshold_signals"]
