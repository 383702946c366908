"""Places chosen by pointing: where a model would put a thing, the best place near a point, what is wrong there."""
