"""Fields of an accepted state: for ParaView, at a point, where the material is unstable, where volumes are off."""
