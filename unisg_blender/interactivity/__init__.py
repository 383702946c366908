"""Lessons as behaviour graphs of the glTF standard KHR_interactivity: pure data, for any player of it."""

from __future__ import annotations

from .lesson_compiler import LessonGraph, lesson_graph

__all__ = ["LessonGraph", "lesson_graph"]
