"""Random scenes with everything that makes a round trip hard."""

from __future__ import annotations

import json

import hypothesis.strategies as st
import numpy as np
from hypothesis.extra import numpy as arrays

from unisg_blender.scene import (
    ActionData,
    FrameRange,
    LessonNode,
    Material,
    Mesh,
    Relation,
    SceneGraph,
    Thresholds,
    table,
)
from unisg_blender.scene.assembly import Columns, assemble
from unisg_blender.scene.properties import ObjectProperties

NAMES = st.one_of(
    st.sampled_from(["Cube", "Cube.001", "手術刀", "a/b", 'say "hi"', "it's", "\\", "", " ", "1", "_meshes", "müde"]),
    st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=12),
)
NUMBERS = st.floats(-100, 100, width=32)
VALUES = st.one_of(
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(allow_nan=False),
    NAMES,
    st.lists(st.integers(-5, 5), max_size=3),
    st.lists(NUMBERS, max_size=3),
    st.dictionaries(NAMES, NUMBERS, max_size=2),
    st.none(),
)


@st.composite
def matrices(draw: st.DrawFn) -> np.ndarray:
    """Any affine matrix: shear, mirrors and zero scale included."""
    matrix = np.eye(4)
    matrix[:3] = draw(arrays.arrays(np.float64, (3, 4), elements=NUMBERS))
    return matrix


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """A mesh of up to four faces, with or without normals, UVs, loose edges and materials."""
    count = draw(st.integers(3, 8))
    faces = draw(st.lists(st.lists(st.integers(0, count - 1), min_size=3, max_size=5), max_size=4))
    corners = np.array([point for face in faces for point in face], np.int32)
    offsets = np.concatenate([[0], np.cumsum([len(face) for face in faces])]).astype(np.int32)
    values = arrays.arrays(np.float32, (len(corners), 3), elements=NUMBERS)
    slots = draw(st.lists(st.sampled_from(["Red", "Steel", "手"]), max_size=3, unique=True))
    index = arrays.arrays(np.int32, (len(faces),), elements=st.integers(0, max(len(slots) - 1, 0)))
    return Mesh(
        name=draw(NAMES),
        points=draw(arrays.arrays(np.float32, (count, 3), elements=NUMBERS)),
        corners=corners,
        offsets=offsets,
        edges=draw(arrays.arrays(np.int32, (draw(st.integers(0, 2)), 2), elements=st.integers(0, count - 1))),
        normals=draw(st.none() | values),
        uvs={name: draw(values)[:, :2].copy() for name in draw(st.lists(NAMES.filter(bool), max_size=2, unique=True))},
        material_index=draw(st.none() | index) if slots else None,
        materials=tuple(slots),
    )


@st.composite
def properties(draw: st.DrawFn, uid: str, uids: list[str]) -> ObjectProperties:
    """Category, actions, relations, lesson and custom properties of one object."""
    some = st.lists(st.sampled_from([*uids, "elsewhere"]), max_size=2, unique=True).map(tuple)
    action = ActionData(
        f"{uid}.action", draw(st.sampled_from(["Insert", "Remove", "Question"])), draw(NAMES), draw(some), draw(some),
        reference=draw(st.none() | st.just((*map(float, range(12)), 0.0, 0.0, 0.0, 1.0))),
        thresholds=Thresholds(distance=0.25),
    )  # fmt: skip
    kinds = st.sampled_from(["on_top_of", "inside", "next to", "手"])
    relations = draw(st.lists(st.tuples(kinds, st.sampled_from([*uids, "elsewhere"])), max_size=3, unique=True))
    lesson = LessonNode("operation", "op", draw(NAMES), children=(LessonNode("lesson", "l", optional=True),))
    return ObjectProperties(
        category=draw(st.sampled_from(["", "Scalpel", "Table"])),
        uid=uid,
        actions=(action,) if draw(st.booleans()) else (),
        relations=tuple(Relation(kind, target) for kind, target in relations),
        lsa=lesson if draw(st.booleans()) else None,
        others=draw(st.dictionaries(NAMES.filter(lambda name: name not in ("", " ")), VALUES, max_size=3)),
    )


@st.composite
def scenes(draw: st.DrawFn) -> SceneGraph:
    """A hierarchy of up to eight entities with shared meshes and components of many kinds."""
    count = draw(st.integers(0, 8))
    uids = [f"uid {row}" for row in range(count)]
    shapes = draw(st.lists(meshes(), max_size=3))
    mesh = np.array([draw(st.integers(-1, len(shapes) - 1)) for _ in range(count)], np.int32)
    kinds = [
        "MESH" if index >= 0 else draw(st.sampled_from(["EMPTY", "ARMATURE", "CAMERA", "LIGHT"])) for index in mesh
    ]
    graph = assemble(
        Columns(
            name=[draw(NAMES) for _ in range(count)],
            type=[draw(st.sampled_from([kind, "CURVE"])) for kind in kinds],
            parent=np.array([draw(st.integers(-1, row - 1)) for row in range(count)], np.int32),
            local=np.array([draw(matrices()) for _ in range(count)]).reshape(-1, 4, 4),
            mesh=mesh,
            meshes=shapes,
            properties=[draw(properties(uid, uids)) for uid in uids],
            materials={"Red": Material("Red", (1.0, 0.0, 0.0, 0.5), 0.25, 0.75), "手": Material("手")},
            title=draw(NAMES.filter(bool)),
        )
    )
    return _with_components(draw, graph.replace(frames=draw(st.none() | frame_ranges())))


def frame_ranges() -> st.SearchStrategy[FrameRange]:
    """Frames with fractions, at rates such as 29.97."""
    start, length = st.floats(-100, 2000, width=32), st.integers(0, 2000)
    rate = st.sampled_from([24.0, 25.0, 30.0, 30000 / 1001, 60.0, 0.5])
    return st.builds(
        lambda begin, frames, rate: FrameRange(begin + 1, begin, begin + frames, rate), start, length, rate
    )


def _with_components(draw: st.DrawFn, graph: SceneGraph) -> SceneGraph:
    rows = [row for row in range(len(graph)) if draw(st.booleans())]
    times = [np.sort(draw(arrays.arrays(np.float64, 3, elements=st.floats(0, 9, width=16), unique=True))) for _ in rows]
    poses = [np.array([draw(matrices()) for _ in range(3)]) for _ in rows]
    made = {
        "world": table(rows, matrix=np.array([draw(matrices()) for _ in rows]).reshape(-1, 4, 4)),
        "animation": table(rows, times=times, matrices=poses),
        "recording": table(rows, times=times, matrices=poses),
        "events": table(
            rows, time=np.array([draw(st.integers(0, 9)) for _ in rows], float), action=["a b"] * len(rows),
            event=["performed"] * len(rows),
        ),
        "collections": table(rows, path=[("Tools", draw(NAMES)) for _ in rows]),
        "of our own / 1": table(
            rows, flag=np.ones(len(rows), bool), small=np.arange(len(rows), dtype=np.int8),
            single=np.ones((len(rows), 2, 3), np.float32), text=np.array(["é"] * len(rows), "<U4"),
            anything=[json.loads('{"a": [1, null, "x"]}')] * len(rows),
        ),
    }  # fmt: skip
    for name, component in made.items():
        if draw(st.booleans()):
            graph = graph.with_component(name, component)
    return graph
