"""Judges that are not ours, or that follow definitions of others: a simulator, SceneEval's measures."""
