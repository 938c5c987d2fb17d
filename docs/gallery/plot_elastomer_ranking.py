"""
Elastomer ranking: seven silicones by sensor, durometer and hand
================================================================

Seven elastomers were ranked in the thesis by a threshold sensor, a durometer and by hand. The experiment finds for each the
modulus at which the solver gives the measured threshold, and then the durometer reading of that modulus.
"""

from pathlib import Path

import tactsim as ts

# %%
# The answer depends on the shape of the stress-strain curve, which was measured for two of the seven. The case takes three
# shapes: those of the two measured ones, and a neo-Hookean energy.
case = ts.load_case("elastomers")
for shape in case.experiment.shapes:
    print(shape.name, shape.material.kind)

# %%
# Of each shape one indentation and one durometer are solved, and all else follows by scaling with the modulus. Together they take
# two minutes; this page reads the result that they left.
folder = Path("stored/elastomer_ranking")
if not folder.exists():
    case.run().save(folder)
result = ts.load_result(folder)
print(result.reason)

# %%
# Durometer, hand and sensor give one order. The predicted readings keep it for the harder ones; the softest are predicted off the
# scale, and share a rank.
result.plot("elastomer_ranking")
