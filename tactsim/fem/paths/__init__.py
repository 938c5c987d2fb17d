"""Steps along a path of loads or times: their lengths, events on the way, and headway."""
