"""Damaged and hostile files end in one clear error or in a clean scene, and nothing is ever half-written."""

from __future__ import annotations

import contextlib
import warnings
from pathlib import Path

import numpy as np
import pytest

from tests.usd.compare import assert_same_graph
from unisg_blender import UniSGError
from unisg_blender.scene import Mesh, SceneBuilder, mesh_from_faces, table
from unisg_blender.scene.mesh import check_mesh
from unisg_blender.usd import read_usd, write_usd

TRIANGLE = mesh_from_faces("Triangle", np.eye(3), [[0, 1, 2]])

INSTANCER = """def PointInstancer "{name}" {{
int[] protoIndices = [0]
point3f[] positions = [(0, 0, 0)]
rel prototypes = <{target}>
}}
"""


def small_scene(name: str = "A") -> SceneBuilder:
    builder = SceneBuilder("Room")
    builder.add(name, uid="a", mesh=TRIANGLE)
    return builder


def text_file(folder: Path, body: str) -> Path:
    path = folder / "scene.usda"
    path.write_text("#usda 1.0\n" + body, encoding="utf-8")
    return path


def read_quietly(path: Path) -> tuple[object, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        graph = read_usd(path)
    return graph, [str(item.message) for item in caught]


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("ending", ["usdc", "usda", "usdz"])
def test_truncated(tmp_path: Path, ending: str, share: float) -> None:
    path = tmp_path / f"scene.{ending}"
    write_usd(small_scene().build(), path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(len(whole) * share)])
    with pytest.raises(UniSGError, match="not a readable USD file"):
        read_usd(path)


@pytest.mark.parametrize("seed", range(8))
def test_flipped_bytes(tmp_path: Path, seed: int) -> None:
    """Random damage is an error or a scene, never anything else."""
    path = tmp_path / "scene.usdc"
    write_usd(small_scene().build(), path)
    data = np.frombuffer(path.read_bytes(), np.uint8).copy()
    rng = np.random.default_rng(seed)
    data[rng.integers(0, len(data), 20)] ^= 0xFF
    path.write_bytes(data.tobytes())
    with contextlib.suppress(UniSGError):
        assert read_quietly(path)[0] is not None


def test_not_there_and_wrong_endings(tmp_path: Path) -> None:
    for path in (tmp_path / "none.usda", tmp_path / "none.txt", tmp_path):
        with pytest.raises(UniSGError):
            read_usd(path)
    for path in (tmp_path / "folder" / "a.usda", tmp_path / "a.txt"):
        with pytest.raises(UniSGError):
            write_usd(small_scene().build(), path)
    assert not list(tmp_path.iterdir())


def test_deep_nesting_is_refused(tmp_path: Path) -> None:
    path = text_file(tmp_path, 'def "a" {\n' * 50_000 + "}\n" * 50_000)
    with pytest.raises(UniSGError, match="nest 50000 deep"):
        read_usd(path)


@pytest.mark.parametrize(
    "body",
    [
        'def Xform "a" (references = </b>) {\n}\ndef Xform "b" (references = </a>) {\n}\n',
        'def Xform "a" (references = @./scene.usda@</a>) {\n}\n',
        '(subLayers = [@./scene.usda@])\ndef Xform "a" {\n}\n',
        'def Xform "a" (references = @./nothing.usda@) {\n}\n',
        INSTANCER.format(name="a", target="/no"),
    ],
)
def test_broken_references_are_told(tmp_path: Path, body: str) -> None:
    graph, told = read_quietly(text_file(tmp_path, body))
    assert "a" in graph.name
    assert told


def test_references_that_unfold_without_end_are_refused(tmp_path: Path) -> None:
    """Ten references to ten references to ...: a small file that stands for millions of prims."""
    levels = []
    for level in range(8):
        below = "".join(f'def "c{number}" (references = </p{level + 1}>) {{\n}}\n' for number in range(10))
        levels.append(f'def "p{level}" {{\n{below}}}\n')
    path = text_file(tmp_path, "".join(levels) + 'def "p8" {\n}\n')
    with pytest.raises(UniSGError, match="unfold into"):
        read_usd(path)


def test_numbers_that_are_none(tmp_path: Path) -> None:
    body = """def Xform "a" {
        matrix4d xformOp:transform = ((nan, 0, 0, 0), (0, inf, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
        uniform token[] xformOpOrder = ["xformOp:transform"]
        def Sphere "s" {
            double radius = inf
        }
    }
    """
    graph, lines = read_quietly(text_file(tmp_path, body))
    assert np.isfinite(graph.local).all()
    assert any("/a: its transform" in line for line in lines)
    assert any("/a/s: some points" in line for line in lines)


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "scene.usda"
    write_usd(small_scene().build(), path)
    path.write_bytes(path.read_bytes().replace(b"matrix4d", b"mat\x92\xffd"))
    with pytest.raises(UniSGError, match="not a readable USD file"):
        read_usd(path)


def test_a_prototype_of_itself(tmp_path: Path) -> None:
    body = INSTANCER.format(name="p", target="/p")
    with pytest.raises(UniSGError, match="prototype of itself"):
        read_usd(text_file(tmp_path, body))


@pytest.mark.parametrize("faces", ["[3]", "[3, -1]", "[2000000000]"])
def test_damaged_faces(tmp_path: Path, faces: str) -> None:
    arrays = f"int[] faceVertexCounts = {faces}\nint[] faceVertexIndices = [0, 1, 99]"
    body = f'def Mesh "m" {{\npoint3f[] points = [(0, 0, 0)]\n{arrays}\n}}\n'
    graph, told = read_quietly(text_file(tmp_path, body))
    assert len(graph.meshes[0].points) == 1
    assert len(graph.meshes[0].offsets) == 1
    assert any("faces are left out" in text for text in told)


def test_nonsense_of_our_own(tmp_path: Path) -> None:
    """Attributes of the wrong type, bad JSON, damaged tables: what is readable is read."""
    body = """def Xform "S" {
        custom int unisg:version = 1
        class Scope "_components" {
            def "x" {
                custom string[] unisg:entities = ["a"]
                custom string unisg:columns = '{"c": {"name": "c", "form": "O", "shape": [99999999]}}'
            }
            def "y" {
            }
        }
        def Xform "m" {
            custom int unisg:uid = 3
            custom double unisg:category = 2
            custom string unisg:actions = "[{"
            custom string unisg:lsa = "x"
            custom double3 unisg:world = (1, 2, 3)
            custom string unisg:type = "Nonsense"
            custom string unisg:properties = "[]"
            custom int unisg:events = 3
            custom string unisg:recording = "x"
        }
    }
    """
    graph, told = read_quietly(text_file(tmp_path, body))
    assert graph.name == ("m",)
    assert len(told) >= 5


def test_newer_version(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="update it"):
        read_usd(text_file(tmp_path, 'def Xform "S" {\ncustom int unisg:version = 99\n}\n'))


def test_duplicate_uids(tmp_path: Path) -> None:
    body = 'def Xform "a" {\ncustom string unisg:uid = "u"\ndef Xform "b" {\ncustom string unisg:uid = "u"\n}\n}\n'
    graph = read_usd(text_file(tmp_path, body))
    assert graph.uid[0] == "u"
    assert len(set(graph.uid)) == 2


@pytest.mark.parametrize(
    "name", ["x" * 10_000, "手術" * 100, "\"quotes' \\ / slashes", "line\nbreak\ttab", "🦴", "a\u0301"]
)
def test_names(tmp_path: Path, name: str) -> None:
    graph = small_scene(name).build()
    for ending in ("usda", "usdc"):
        write_usd(graph, tmp_path / f"scene.{ending}")
        assert_same_graph(graph, read_usd(tmp_path / f"scene.{ending}"))


def test_names_that_are_no_text(tmp_path: Path) -> None:
    """Zero characters and lone surrogates are replaced, and the rest stays."""
    write_usd(small_scene("a\0b\ud800c").build(), tmp_path / "scene.usda")
    assert read_usd(tmp_path / "scene.usda").name == ("ab?c",)


def test_degenerate_meshes(tmp_path: Path) -> None:
    none = np.zeros(0, np.int32)
    shapes = [
        Mesh("No points", np.zeros((0, 3), np.float32), none, np.zeros(1, np.int32)),
        Mesh("No faces", np.ones((4, 3), np.float32), none, np.zeros(1, np.int32)),
        Mesh("NaN", np.full((3, 3), np.nan, np.float32), np.arange(3, dtype=np.int32), np.array([0, 3], np.int32)),
        Mesh("One point", np.zeros((1, 3), np.float32), np.zeros(3, np.int32), np.array([0, 3], np.int32)),
        Mesh("Two corners", np.eye(3, dtype=np.float32), np.arange(2, dtype=np.int32), np.array([0, 2], np.int32)),
    ]
    builder = SceneBuilder("Room")
    for number, mesh in enumerate(shapes):
        builder.add(mesh.name, uid=str(number), mesh=mesh)
    graph = builder.build()
    write_usd(graph, tmp_path / "scene.usda")
    found, _ = read_quietly(tmp_path / "scene.usda")
    assert_same_graph(graph, found)


def test_failed_writing_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.usda"
    write_usd(small_scene().build(), path)
    before = path.read_bytes()
    bad = small_scene().build().with_component("odd", table([0], obj=[object()]))
    with pytest.raises(UniSGError, match="odd"):
        write_usd(bad, path)
    assert path.read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["scene.usda"]


def test_a_projective_transform_is_read_as_affine_and_told(tmp_path: Path) -> None:
    body = """def Xform "A" {
matrix4d xformOp:transform = ((1, 0, 0, 4), (0, 1, 0, 8), (0, 0, 1, 12), (13, 14, 15, 1))
uniform token[] xformOpOrder = ["xformOp:transform"]
}
"""
    graph, told = read_quietly(text_file(tmp_path, '(\nupAxis = "Z"\nmetersPerUnit = 1\n)\n' + body))
    assert graph["A"].local.tolist() == [[1, 0, 0, 13], [0, 1, 0, 14], [0, 0, 1, 15], [0, 0, 0, 1]]
    assert [text for text in told if "projective" in text] == ["/A: its transform is projective; read as affine"]


TWO_FACES = """#usda 1.0
def Mesh "Box"
{
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    int[] faceVertexCounts = [3, 3]
    int[] faceVertexIndices = [0, 1, 2, 2, 1, 0]
    uniform token subdivisionScheme = "none"
"""


def test_slots_of_types_that_usd_does_not_know_are_found_by_their_names(tmp_path: Path) -> None:
    path = tmp_path / "slots.usda"
    path.write_text(
        TWO_FACES
        + """    custom nothing[] unisg:materials = ["a"]
    uniform token subsetFamily:materialBind:familyType = "partition"
    def GeomSubset "one"
    {
        uniform token familyName = "materialBind"
        uniform token elementType = "face"
        int[] indices = [0]
    }
    def GeomSubset "two"
    {
        uniform token familyName = "materialBind"
        uniform token elementType = "face"
        int[] indices = [1]
        custom uniform nothing unisg:slot = 1
    }
}
"""
    )
    assert read_usd(path)["Box"].mesh.materials == ("one", "two")


def test_a_slot_that_is_not_there_is_the_last_one(tmp_path: Path) -> None:
    path = tmp_path / "slots.usda"
    path.write_text(
        TWO_FACES
        + """    custom string[] unisg:materials = ["a", "b"]
    uniform token subsetFamily:materialBind:familyType = "partition"
    def GeomSubset "two"
    {
        uniform token familyName = "materialBind"
        uniform token elementType = "face"
        int[] indices = [1]
        custom int unisg:slot = 12
    }
}
"""
    )
    mesh = read_usd(path)["Box"].mesh
    check_mesh(mesh)
    assert (mesh.materials, mesh.material_index.tolist()) == (("a", "b"), [0, 1])


@pytest.mark.parametrize("old", ["int[] faceVertexIndices", "int[] faceVertexCounts", "point3f[] points"])
def test_a_mesh_whose_numbers_have_a_type_that_is_none_loses_its_faces(tmp_path: Path, old: str) -> None:
    path = tmp_path / "scene.usda"
    write_usd(small_scene().build(), path)
    path.write_text(path.read_text().replace(old, "nothing[] " + old.split()[1]))
    graph, told = read_quietly(path)
    assert graph.name == ("A",)
    assert not any(len(mesh.corners) for mesh in graph.meshes)
    assert [text for text in told if "faces are left out" in text]


def test_a_category_that_is_no_text_is_told(tmp_path: Path) -> None:
    builder = SceneBuilder("Room")
    builder.add("A", uid="a", category="Cup")
    path = tmp_path / "scene.usda"
    write_usd(builder.build(), path)
    text = path.read_text()
    assert 'string unisg:category = "Cup"' in text
    path.write_text(text.replace("string unisg:category", "nothing unisg:category"))
    graph, told = read_quietly(path)
    assert graph.category_name(0) == ""
    assert [text for text in told if "unisg_category must be a string" in text]


def test_what_stumbles_over_a_file_is_told_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from unisg_blender.usd.read import stage_reader

    def stumbles(*args, **options):
        return [][1]

    path = tmp_path / "scene.usda"
    write_usd(small_scene().build(), path)
    monkeypatch.setattr(stage_reader, "find_entities", stumbles)
    with pytest.raises(UniSGError, match=r"scene\.usda: is it damaged\? .*report this: IndexError"):
        read_usd(path)
