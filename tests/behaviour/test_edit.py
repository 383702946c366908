from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.behaviour.lesson.edit import change, find, insert, lift, move, nest, remove
from unisg_blender.errors import UniSGError
from unisg_blender.scene import LessonNode
from unisg_blender.scene.lesson_node import MAY_HOLD, lesson_from_json, lesson_to_json

UIDS = ("op", "l1", "l2", "s1", "s2", "s3", "a", "b", "c")


def tree():
    first = LessonNode("stage", "s1", children=(LessonNode("action", "a"), LessonNode("action", "b")))
    second = LessonNode("stage", "s2", children=(LessonNode("action", "c", requires=("a", "b")),), requires=("s1",))
    inner = LessonNode("lesson", "l2", children=(LessonNode("stage", "s3"),))
    return LessonNode("operation", "op", children=(LessonNode("lesson", "l1", children=(first, second, inner)),))


def shape(node):
    return node.uid if not node.children else {node.uid: [shape(child) for child in node.children]}


def test_move_within_a_stage_and_over_its_end():
    assert shape(move(tree(), "b", -1)) == {"op": [{"l1": [{"s1": ["b", "a"]}, {"s2": ["c"]}, {"l2": ["s3"]}]}]}
    assert shape(move(tree(), "b", 1)) == {"op": [{"l1": [{"s1": ["a"]}, {"s2": ["b", "c"]}, {"l2": ["s3"]}]}]}
    assert shape(move(tree(), "c", -1)) == {"op": [{"l1": [{"s1": ["a", "b", "c"]}, "s2", {"l2": ["s3"]}]}]}
    assert move(tree(), "a", -1) == tree()
    assert move(tree(), "op", 1) == tree()


def test_nest_and_lift():
    assert shape(nest(tree(), "s2")) == shape(tree())  # a stage holds no stage
    assert shape(lift(tree(), "s3")) == {"op": [{"l1": [{"s1": ["a", "b"]}, {"s2": ["c"]}, "l2", "s3"]}]}
    lifted = lift(tree(), "l2")
    assert shape(lifted) == {"op": [{"l1": [{"s1": ["a", "b"]}, {"s2": ["c"]}]}, {"l2": ["s3"]}]}
    assert nest(lifted, "l2") == tree()


def test_remove_takes_requirements_along():
    left = remove(tree(), "s1")
    assert find(left, "c").requires == ()
    assert find(left, "s2").requires == ()
    with pytest.raises(UniSGError, match="cannot be removed"):
        remove(tree(), "op")
    with pytest.raises(UniSGError, match="no node"):
        remove(tree(), "zz")
    with pytest.raises(UniSGError, match="no node"):
        change(tree(), "zz", lambda node: node)


def test_only_what_fits_goes_in():
    with pytest.raises(UniSGError, match="a lesson cannot hold an action"):
        insert(tree(), "l1", LessonNode("action", "x"))


@given(st.lists(st.tuples(st.sampled_from((move, nest, lift)), st.sampled_from(UIDS))))
@settings(max_examples=100, deadline=None)
def test_any_edits_keep_every_node_once_in_a_tree_that_can_be_read(edits):
    root = tree()
    for edit, uid in edits:
        root = edit(root, uid, 1) if edit is move else edit(root, uid)
        assert lesson_from_json(lesson_to_json(root)) == root
        assert sorted(node.uid for node in root.walk()) == sorted(node.uid for node in tree().walk())
        assert all(child.kind in MAY_HOLD[node.kind] for node in root.walk() for child in node.children)
