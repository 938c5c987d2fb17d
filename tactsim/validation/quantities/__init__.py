"""The numbers and figures of the thesis as functions by topic; a table calls them by their names."""
