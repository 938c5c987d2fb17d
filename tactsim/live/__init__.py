"""The live page: three views, a 3D view and the taxels of a grasp in a browser, from a result, a data set or a sensor."""
