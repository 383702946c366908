"""Which symmetry helps networks over the objects of rooms: the same small networks with more or less of it built in."""
