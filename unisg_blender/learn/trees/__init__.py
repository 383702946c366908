"""Random trees that judge plain proposals: a generator from few rooms."""
