"""Estimators of lumps on the grasps of a data set: judged, compared, confused, trained."""
