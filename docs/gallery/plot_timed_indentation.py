"""
Timed indentation: press, hold and oscillate on tissue that relaxes
===================================================================

Tissue flows: under a constant force a sensor goes on sinking, and a fast push meets more resistance than a slow one. Here the
force on the annular sensor grows, is held, and then oscillates, at finite strain and with friction.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# A soft silicone with a relaxation: 30 % of its stress fades with a time constant of 0.1 s, 20 % more with one of 2 s. The solver
# chooses its steps of time by an estimate of their error, here 2 %.
indentation = ts.TimedIndentation(
    specimen=ts.Specimen(
        material={"set": "icf_stable", "relaxation": {"fractions": [0.3, 0.2], "times": ["0.1 s", "2 s"]}},
        thickness="6 mm",
        radius="12 mm",
    ),
    body=ts.Annulus(inner_radius="1.5 mm", outer_radius="3 mm", fillet="0.3 mm"),
    loading={
        "control": "force",
        "pieces": [
            {"kind": "ramp", "to": "60 mN", "duration": "0.5 s"},
            {"kind": "hold", "duration": "2 s"},
            {"kind": "sine", "amplitude": "20 mN", "frequency": "1 Hz", "duration": "1 s"},
        ],
    },
    mesh={"finest": "0.2 mm", "growth": 0.6},
    time={"tolerance": 0.02},
)

# %%
# The run takes half a minute; this page reads the result that it left.
folder = Path("stored/timed_indentation")
if not folder.exists():
    indentation.run().save(folder)
result = ts.load_result(folder)
print(result)

# %%
# The upper curve is prescribed, the others follow. In the hold the sensor creeps; in the oscillation it lags behind the force.
result.plot("timed_indentation")

# %%
# Drawn over each other, force and displacement of the oscillation make a loop. Its area is the work that the tissue turns to heat
# in a cycle; an elastic specimen would draw a line.
history = result.history
figure, axis = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
axis.plot(1e3 * history["displacement"], 1e3 * history["reaction_force"], color="0.75", label="all")
loop = history.where(history["time"] >= 2.5, drop=True)
axis.plot(1e3 * loop["displacement"], 1e3 * loop["reaction_force"], marker=".", label="oscillation")
axis.set(xlabel="displacement in mm", ylabel="force in mN")
axis.legend(frameon=False)
plt.show()
