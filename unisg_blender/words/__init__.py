"""What things are called: names and categories of any scene, understood in the vocabulary of a model."""

from __future__ import annotations

from .category_mapping import apply_mapping, read_mapping
from .scene_words import SceneWords, Understood, understand
from .vocabulary_match import VocabularyMatch, WordMatch
from .word_table import Thing, WordTable, thing_table

__all__ = [
    "SceneWords",
    "Thing",
    "Understood",
    "VocabularyMatch",
    "WordMatch",
    "WordTable",
    "apply_mapping",
    "read_mapping",
    "thing_table",
    "understand",
]  # fmt: skip
