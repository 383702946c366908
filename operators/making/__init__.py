"""Make rooms and put things into them with a model: chosen, placed, settled, placed anew, suggested."""
