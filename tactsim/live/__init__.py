"""The live page: three views, a view in space and the taxels of a grasp in a browser, from a result, a data set or a sensor."""
