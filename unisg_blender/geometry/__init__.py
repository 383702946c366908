"""Geometry on plain arrays: boxes, polygons, planar poses, contact of surfaces. Knows no scene."""
