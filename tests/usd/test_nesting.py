"""Files that nest too deeply are refused, wherever the depth is hidden; braces in names and comments do not count."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.scene import SceneBuilder, realize
from unisg_blender.usd import read_usd, write_usd
from unisg_blender.usd.read.nesting import DEEPEST, check_nesting

HEAD = "#usda 1.0\n"
DEEP = 3000  # more than is read, less than ends a process


def prims(depth: int, within: str = "") -> str:
    return HEAD + f'def "a"\n{{\n{within}\n' * depth + "}\n" * depth


def written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text",
    [
        prims(DEEP),
        prims(DEEP, "# }"),
        prims(DEEP, "/* } */"),
        prims(DEEP, "// }"),
        prims(DEEP, 'custom string x = "}"'),
        prims(DEEP, "custom string x = '''}\n}'''"),
        prims(DEEP, "custom asset x = @}@"),
        HEAD + "(\ncustomLayerData = {\n" + "dictionary a = {\n" * DEEP + "}\n" * DEEP + "}\n)\n",
        HEAD + 'def "a"\n{\ncustom double[] x = ' + "[" * DEEP + "]" * DEEP + "\n}\n",
    ],
)
def test_deep_text_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(UniSGError, match=f"nest [0-9]+ deep in it, more than the {DEEPEST} that can be read"):
        read_usd(written(tmp_path / "deep.usda", text))


REFERENCES = {
    "sublayer": "(\nsubLayers = [@deep.usda@]\n)\n",
    "reference": 'def "x" (references = @deep.usda@</a>)\n{\n}\n',
    "payload": 'def "x" (payload = @deep.usda@</a>)\n{\n}\n',
    "package": 'def "x" (references = @deep.usdz@</a>)\n{\n}\n',
    "within a package": 'def "x" (references = @deep.usdz[deep.usda]@</a>)\n{\n}\n',
    "variant": 'def "x" (variantSets = "v")\n{\nvariantSet "v" = {\n"b" (references = @deep.usda@</a>) {\n}\n}\n}\n',
    "expression": '(\nexpressionVariables = {\nstring X = "deep"\n}\nsubLayers = [@`"${X}.usda"`@]\n)\n',
    "materials": 'def "x" (references = @deep.mtlx@</MaterialX>)\n{\n}\n',
}


@pytest.mark.parametrize("way", REFERENCES)
def test_deep_text_that_another_file_refers_to_is_refused(tmp_path: Path, way: str) -> None:
    written(tmp_path / "deep.usda", prims(DEEP))
    written(tmp_path / "deep.mtlx", "<a>" * DEEP + "</a>" * DEEP)
    with zipfile.ZipFile(tmp_path / "deep.usdz", "w") as package:
        package.write(tmp_path / "deep.usda", "deep.usda")
    with pytest.raises(UniSGError, match="deep in it"):
        read_usd(written(tmp_path / "stage.usda", HEAD + REFERENCES[way]))


def test_braces_in_names_do_not_count(tmp_path: Path) -> None:
    builder = SceneBuilder("Many [screws")
    for number in range(2 * DEEPEST):
        builder.add("Screw M3 (long 12 {", uid=str(number))
    write_usd(builder.build(), tmp_path / "screws.usda")
    assert read_usd(tmp_path / "screws.usda").name[0] == "Screw M3 (long 12 {"


@pytest.mark.parametrize("text", ['"""' * 100_001, "/*" * 100_000, '"\\' * 100_000, "@@@" * 100_001])
def test_looking_takes_no_longer_for_odd_text(tmp_path: Path, text: str) -> None:
    """Quadratic searching would take minutes here."""
    check_nesting(written(tmp_path / "odd.usda", HEAD + text))


@pytest.mark.parametrize("levels", [500, 5000])
def test_a_hierarchy_is_written_if_it_can_be_read(tmp_path: Path, levels: int) -> None:
    builder = SceneBuilder()
    for number in range(levels):
        builder.add(f"link {number}", uid=str(number), parent=number - 1)
    if levels < DEEPEST:
        write_usd(builder.build(), tmp_path / "chain.usda")
        assert len(read_usd(tmp_path / "chain.usda")) == levels
    else:
        with pytest.raises(UniSGError, match="levels of parents"):
            write_usd(builder.build(), tmp_path / "chain.usda")
        assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_pipes_and_devices_are_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    with pytest.raises(UniSGError, match="is no file"):
        read_usd(tmp_path / "pipe.usda")
    for name in ("pipe.usda", "/dev/zero"):
        with pytest.raises(UniSGError, match="is no file: a scene cannot be read from a pipe or a device"):
            read_usd(written(tmp_path / "stage.usda", f"{HEAD}(\nsubLayers = [@{name}@]\n)\n"))


GARBAGE = np.random.default_rng(7).bytes(3000)


@pytest.mark.parametrize("start", [b"", b"#usda 1.0\n", b"PXR-USDC", b"PK\x03\x04"])
@pytest.mark.parametrize("ending", ["usda", "usdc", "usd", "usdz"])
def test_garbage_is_refused_in_one_line(tmp_path: Path, ending: str, start: bytes) -> None:
    path = tmp_path / f"garbage.{ending}"
    path.write_bytes(start + GARBAGE)
    with pytest.raises(UniSGError) as refused:
        read_usd(path)
    assert len(str(refused.value).splitlines()) == 1
    assert not any(word in str(refused.value) for word in ("line 48", ".cpp", "pxrInternal", "0x"))


def instancers(levels: int, copies: int = 100) -> str:
    """Point instancers, each with ``copies`` of the next one."""
    text = 'def Mesh "m"\n{\npoint3f[] points = [(0, 0, 0)]\nuniform token subdivisionScheme = "none"\n}\n'
    for level in reversed(range(levels)):
        places = ", ".join(f"({place}, 0, 0)" for place in range(copies))
        text = (
            f'def PointInstancer "p"\n{{\nrel prototypes = </W{"/p/x" * (level + 1)}>\n'
            f"int[] protoIndices = [{', '.join('0' * copies)}]\npoint3f[] positions = [{places}]\n"
            f'def Xform "x"\n{{\n{text}}}\n}}\n'
        )
    return f'{HEAD}def Xform "W"\n{{\n{text}}}\n'


def test_instances_are_counted_before_they_are_made(tmp_path: Path) -> None:
    graph = read_usd(written(tmp_path / "six.usda", instancers(6)))
    with pytest.raises(UniSGError, match="would be 1,020,202,020,200 entities, more than 1,000,000: keep them"):
        realize(graph)
    assert len(realize(read_usd(written(tmp_path / "two.usda", instancers(2, 10))))) > 100


def test_instancers_without_end_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="its instances nest too deeply to be read"):
        read_usd(written(tmp_path / "deep.usda", instancers(240, 1)))


@pytest.mark.parametrize("depth", [DEEPEST - 100, DEEPEST + 1])
def test_deep_binary_files_are_refused(tmp_path: Path, depth: int) -> None:
    from pxr import Sdf

    layer = Sdf.Layer.CreateNew(str(tmp_path / "deep.usdc"))
    path = Sdf.Path("/a")
    for _ in range(depth):
        prim = Sdf.CreatePrimInLayer(layer, path)
        prim.specifier, prim.typeName, path = Sdf.SpecifierDef, "Xform", path.AppendChild("a")
    layer.Save()
    if depth < DEEPEST:
        assert len(read_usd(tmp_path / "deep.usdc")) == depth
        return
    with pytest.raises(UniSGError, match=f"prims nest deeper than the {DEEPEST} that can be read"):
        read_usd(tmp_path / "deep.usdc")
