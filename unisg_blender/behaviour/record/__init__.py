"""Motion and events of entities over time: tracks, scripts, recordings."""
