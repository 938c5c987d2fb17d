"""
Sensor response: what a straight line makes of a film that creeps
=================================================================

A force that oscillates faster and faster acts on a film sensor with noise, a converter and a low pass. The usual reading is a
straight line through the conductance; the other one is the inverse of the film's own model. How far is each off?
"""

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# A chirp from 0.2 to 2 Hz between 0.1 and 2.6 N.
result = ts.load_case("sensor_chirp").run()
print("rms error of the line:", f"{result['rms_error'].to('mN'):.0f}")

# %%
# The line reads too much, and the low pass makes it late. The inverse of the film follows.
result.plot("sensor_response")

# %%
# Reading over force shows it plainly: the line makes a loop, for the film remembers what came before.
history = result.history
figure, axis = plt.subplots(figsize=(4.6, 4.4), layout="constrained")
axis.plot(history["force"], history["read_force"], linewidth=0.6, label="line")
axis.plot(history["force"], history["model_force"], linewidth=0.6, label="inverse of the film")
axis.plot([0, 3], [0, 3], color="black", linestyle="--", linewidth=0.8, label="true")
axis.set(xlabel="applied force in N", ylabel="reading in N", aspect="equal", xlim=(0, 3.2), ylim=(0, 3.2))
axis.legend(frameon=False)
plt.show()
