"""Scenes as glTF 2.0, for whatever shows 3D: geometry, materials, hierarchy, cameras, lights, motion."""
