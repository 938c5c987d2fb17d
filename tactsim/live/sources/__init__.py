"""What a page shows: recordings of results, samples of data sets, live feeds, and the plain tissue beside them."""
