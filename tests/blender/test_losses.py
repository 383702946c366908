"""Whatever Blender can hold and a scenegraph cannot is told, object by object; what is new has nothing to tell."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import pytest

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender.blender import ReadReport, read_scene, write_scene
from unisg_blender.blender.read import scene_reader


def losses(name: str | None = None) -> list[str]:
    """What reading the current scene tells of an object ("": of the scene), or of all."""
    bpy.context.view_layer.update()
    report = ReadReport()
    read_scene(report=report)
    return [text for owner, text in report.entries if name is None or owner == name]


def rig() -> bpy.types.Object:
    item = add("Thing", bpy.data.armatures.new("Rig"))
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    item.data.edit_bones.new("root").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    return item


def camera() -> bpy.types.Object:
    return add("Thing", bpy.data.cameras.new("Camera"))


def light(kind: str = "AREA") -> bpy.types.Object:
    return add("Thing", bpy.data.lights.new("Light", kind))


def cube() -> bpy.types.Object:
    return add("Thing", box())


def sky() -> bpy.types.World:
    world = bpy.data.worlds.new("Sky")
    world.color = (0.2, 0.4, 1)
    return world


def painted() -> bpy.types.Object:
    item = cube()
    item.data.materials.append(bpy.data.materials.new("Paint"))
    item.data.materials[0].use_nodes = True
    return item


def surface(item: bpy.types.Object) -> bpy.types.Node:
    return item.data.materials[0].node_tree.nodes["Principled BSDF"]


NEW: dict[str, Callable[[], object]] = {
    "mesh": cube, "material": painted, "empty": lambda: add("Thing"), "camera": camera, "armature": rig,
    "point cloud": lambda: add("Thing", bpy.data.pointclouds.new("Points")),
} | {kind: (lambda kind=kind: light(kind)) for kind in ("POINT", "SUN", "SPOT", "AREA")}  # fmt: skip


@pytest.mark.parametrize("kind", NEW)
def test_a_new_object_has_nothing_to_lose(kind: str) -> None:
    NEW[kind]()
    assert losses() == []


def test_a_new_scene_with_a_collection_has_nothing_to_lose() -> None:
    bpy.context.scene.collection.children.link(bpy.data.collections.new("Tools"))
    assert losses() == []


def put(owner: object, **values: object) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


def limited() -> None:
    item = cube()
    item["force"] = 1.5
    item.id_properties_ui("force").update(min=0.0, max=2.0)


def constrained_bone() -> None:
    rig().pose.bones[0].constraints.new("LIMIT_LOCATION")


def keyed_bone() -> None:
    rig().pose.bones[0].keyframe_insert("location", frame=1)


def animate(owner: bpy.types.ID, path: str) -> None:
    owner.keyframe_insert(path, frame=1)


def in_collection(**settings: object) -> None:
    collection = bpy.data.collections.new("Thing")
    bpy.context.scene.collection.children.link(collection)
    put(collection, **settings)


def layer(kind: str, domain: str) -> None:
    cube().data.attributes.new("wear", kind, domain)


def particles() -> None:
    cube().modifiers.new("Hair", "PARTICLE_SYSTEM")


def noded_light() -> None:
    item = light("POINT")
    item.data.use_nodes = True
    item.data.node_tree.nodes.new("ShaderNodeTexNoise")


def image_empty() -> None:
    item = add("Thing")
    item.empty_display_type = "IMAGE"
    item.data = bpy.data.images.new("Plan", 4, 4)


def force_field() -> None:
    bpy.ops.object.effector_add(type="WIND")
    bpy.context.object.name = "Thing"


def textured() -> None:
    tree = painted().data.materials[0].node_tree
    tree.nodes.new("ShaderNodeTexImage")


def emissive() -> None:
    surface(painted()).inputs["Emission Strength"].default_value = 3.0


def nla() -> None:
    item = cube()
    animate(item, "location")
    action, item.animation_data.action = item.animation_data.action, None
    item.animation_data.nla_tracks.new().strips.new("Strip", 1, action)


LOST: dict[str, tuple[Callable[[], object], str]] = {
    "camera panorama": (lambda: put(camera().data, type="PANO", passepartout_alpha=0.1), "Passepartout Alpha"),
    "camera aperture": (lambda: put(camera().data.dof, aperture_blades=5), "Blades"),
    "camera in focus": (lambda: put(camera().data.dof, focus_object=add("Other")), "object in focus"),
    "camera images": (lambda: camera().data.background_images.new(), "background images"),
    "camera animation": (lambda: animate(camera().data, "lens"), "animation and drivers of its data"),
    "camera display": (lambda: put(camera().data, show_limits=True), "settings of its data"),
    "light distance": (lambda: put(light("POINT").data, use_custom_distance=True), "Custom Attenuation"),
    "light volume": (lambda: put(light().data, volume_factor=0.5), "Volume Factor"),
    "light nodes": (noded_light, "light nodes"),
    "light linking": (
        lambda: put(light().light_linking, receiver_collection=bpy.data.collections.new("Lit")), "Light Linking",
    ),
    "data properties": (lambda: cube().data.__setitem__("maker", "me"), "of its data are not read: maker"),
    "property limits": (limited, "limits and descriptions"),
    "bone shape": (lambda: put(rig().pose.bones[0], custom_shape=add("Other", box("Shape"))), "custom shapes of bones"),
    "bone collections": (lambda: rig().data.collections.new("Left"), "bone collections"),
    "bone constraints": (constrained_bone, "constraints of bones"),
    "bone settings": (lambda: put(rig().data.bones[0], bbone_segments=4), "settings of bones"),
    "bone locks": (lambda: put(rig().pose.bones[0], lock_ik_x=True), "settings of bones"),
    "bone properties": (lambda: rig().pose.bones[0].__setitem__("ik", 1), "custom properties of bones"),
    "bone animation": (keyed_bone, "animation of bones"),
    "armature display": (lambda: put(rig().data, display_type="STICK"), "settings of its data"),
    "shape keys": (lambda: cube().shape_key_add(name="Basis"), "shape keys"),
    "vertex groups": (lambda: cube().vertex_groups.new(name="Group"), "vertex groups"),
    "vertex colours": (lambda: cube().data.color_attributes.new("Paint", "BYTE_COLOR", "CORNER"), "vertex colours"),
    "crease": (lambda: cube().data.attributes.new("crease_edge", "FLOAT", "EDGE"), "crease_edge"),
    "sharp edges": (lambda: cube().data.attributes.new("sharp_edge", "BOOLEAN", "EDGE"), "sharp edges"),
    "attribute": (lambda: layer("FLOAT", "POINT"), "wear"),
    "texture space": (lambda: put(cube().data, use_auto_texspace=False), "texture space"),
    "modifiers": (lambda: cube().modifiers.new("Bevel", "BEVEL"), "modifiers"),
    "constraints": (lambda: cube().constraints.new("LIMIT_SCALE"), "constraints"),
    "drivers": (lambda: cube().driver_add("hide_render"), "drivers"),
    "NLA": (nla, "NLA tracks"),
    "other animation": (lambda: animate(cube(), "hide_render"), "animation that is not read: hide_render"),
    "particles": (particles, "particle systems"),
    "force field": (force_field, "physics"),
    "collision": (lambda: cube().modifiers.new("Collision", "COLLISION"), "physics"),
    "display as": (lambda: put(cube(), display_type="WIRE"), "Display As"),
    "in front": (lambda: put(cube(), show_in_front=True), "settings that are not read"),
    "colour": (lambda: put(cube(), color=(1, 0, 0, 1)), "Color"),
    "locks": (lambda: put(cube(), lock_location=(True, False, False)), "Lock Location"),
    "not selectable": (lambda: put(cube(), hide_select=True), "settings that are not read"),
    "pass index": (lambda: put(cube(), pass_index=3), "Pass Index"),
    "holdout": (lambda: put(cube(), is_holdout=True), "Holdout"),
    "ray visibility": (lambda: put(cube(), visible_camera=False), "Camera Visibility"),
    "line art": (lambda: put(cube().lineart, usage="EXCLUDE"), "settings that are not read"),
    "image": (image_empty, "image that it shows"),
    "asset": (lambda: cube().asset_mark(), "asset"),
    "textures": (textured, "textures and shader nodes"),
    "emission": (emissive, "Emission Strength"),
    "backface culling": (lambda: put(painted().data.materials[0], use_backface_culling=True), "settings of materials"),
    "material properties": (lambda: painted().data.materials[0].__setitem__("price", 3), "custom properties of mat"),
    "material animation": (
        lambda: animate(surface(painted()).inputs["Roughness"], "default_value"), "animation of materials",
    ),
    "hidden collection": (lambda: in_collection(hide_render=True), "settings of the collection"),
    "collection colour": (lambda: in_collection(color_tag="COLOR_02"), "settings of the collection"),
    "point attributes": (lambda: add("Thing", bpy.data.pointclouds.new("P")).data.attributes.new("r", "FLOAT", "POINT"),
                         "attributes of points"),
    "curve": (lambda: add("Thing", bpy.data.curves.new("C", "CURVE")), "read as a mesh"),
    "lattice": (lambda: add("Thing", bpy.data.lattices.new("L")), "lattice"),
    "speaker": (lambda: add("Thing", bpy.data.speakers.new("S")), "sound"),
    "volume": (lambda: add("Thing", bpy.data.volumes.new("V")), "volume"),
    "probe": (lambda: add("Thing", bpy.data.lightprobes.new("P", "SPHERE")), "probe"),
    "hair": (lambda: add("Thing", bpy.data.hair_curves.new("H")), "hair curves"),
}  # fmt: skip


@pytest.mark.parametrize("case", LOST)
def test_what_is_lost_is_told(case: str) -> None:
    build, text = LOST[case]
    build()
    told = losses("Thing")
    assert any(text in line for line in told), told


def test_reading_leaves_no_trace() -> None:
    for make in NEW.values():
        make()
    blocks = [*bpy.data.objects, *bpy.data.meshes, *bpy.data.cameras, *bpy.data.lights, *bpy.data.materials]
    before = [list(block.keys()) for block in blocks]
    assert losses() == []
    assert [list(block.keys()) for block in blocks] == before
    bpy.data.objects["Thing"]["own"] = 1
    assert losses() == []


def test_settings_of_add_ons_are_told_as_such() -> None:
    bpy.types.Object.maker_price = bpy.props.FloatProperty(default=3.0)
    try:
        item = cube()
        assert losses() == []
        item.maker_price = 5.0
        assert losses("Thing") == ["settings of add-ons are not read: maker_price"]
        assert "properties" not in read_scene().components
    finally:
        del bpy.types.Object.maker_price


def scene_with(**settings: object) -> Callable[[], None]:
    return lambda: put(bpy.context.scene, **settings)


def sequence() -> None:
    editor = bpy.context.scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    length = {"length": 10} if bpy.app.version >= (5, 0, 0) else {"frame_end": 10}
    strips.new_effect("Text", "TEXT", 1, frame_start=1, **length)


LOST_OF_SCENES: dict[str, tuple[Callable[[], object], str]] = {
    "world": (lambda: put(bpy.context.scene, world=sky()), "the world 'Sky'"),
    "view layers": (lambda: bpy.context.scene.view_layers.new("Second"), "only the view layer"),
    "markers": (lambda: bpy.context.scene.timeline_markers.new("Cut", frame=3), "timeline markers"),
    "properties": (lambda: bpy.context.scene.__setitem__("client", "me"), "custom properties of the scene"),
    "preview range": (scene_with(use_preview_range=True), "Use Preview Range"),
    "gravity": (scene_with(gravity=(0, 0, -1)), "Gravity"),
    "resolution": (lambda: put(bpy.context.scene.render, resolution_x=99), "render settings"),
    "units": (lambda: put(bpy.context.scene.unit_settings, scale_length=0.01), "its unit of 0.01 m"),
    "exposure": (lambda: put(bpy.context.scene.view_settings, exposure=2.0), "colour management settings"),
    "text blocks": (lambda: bpy.data.texts.new("script.py"), "text blocks"),
    "sequence": (sequence, "video sequence"),
    "animation": (lambda: animate(bpy.context.scene, "gravity"), "animation of the scene's settings"),
}  # fmt: skip


@pytest.mark.parametrize("case", LOST_OF_SCENES)
def test_what_is_lost_of_scenes_is_told(case: str) -> None:
    build, text = LOST_OF_SCENES[case]
    build()
    told = losses("")
    assert any(text in line for line in told), told


HELD: dict[str, Callable[[], object]] = {
    "lens and clipping": lambda: put(camera().data, lens=35, sensor_width=22, clip_start=0.5, clip_end=33),
    "sensor fit and shift": lambda: put(camera().data, sensor_fit="VERTICAL", shift_x=0.1, shift_y=-0.2),
    "orthographic": lambda: put(camera().data, type="ORTHO", ortho_scale=3),
    "depth of field": lambda: put(camera().data.dof, use_dof=True, focus_distance=3.5, aperture_fstop=1.4),
    "area shape": lambda: put(light().data, shape="ELLIPSE", size=2, size_y=3, spread=1.0),
    "sun": lambda: put(light("SUN").data, energy=3, angle=0.1),
    "spot": lambda: put(light("SPOT").data, energy=30, spot_size=1, spot_blend=0.5, shadow_soft_size=0.2),
    "light factors": lambda: put(light().data, use_shadow=False, diffuse_factor=0.5, specular_factor=0.25),
    "empty": lambda: put(add("Thing"), empty_display_type="CUBE", empty_display_size=0.3),
    "hidden": lambda: put(cube(), hide_render=True, hide_viewport=True),
    "metal": lambda: put(surface(painted()).inputs["Metallic"], default_value=0.7),
    "opacity": lambda: put(surface(painted()).inputs["Alpha"], default_value=0.3),
}  # fmt: skip
if bpy.app.version >= (4, 5):
    HELD["light exposure"] = lambda: put(light().data, exposure=1.5, normalize=False)
    HELD["light temperature"] = lambda: put(light().data, use_temperature=True, temperature=3000)


@pytest.mark.parametrize("case", HELD)
def test_what_is_held_comes_back(case: str) -> None:
    HELD[case]()
    assert losses() == []
    graph = read_scene()
    again = read_scene(write_scene(graph))
    assert_same_scene(graph, again)
    assert [*again.materials.values()][-1:] == [*graph.materials.values()][:1]


def test_what_is_lost_is_looked_up_for_a_report_only(monkeypatch):
    asked = []
    for name in ("report_losses", "report_scene_losses"):
        monkeypatch.setattr(scene_reader, name, lambda *_, name=name: asked.append(name))
    add("Thing").instance_type, collection = "COLLECTION", bpy.data.collections.new("Shown")
    collection.objects.link(bpy.data.objects.new("Part", None))
    bpy.data.objects["Thing"].instance_collection = collection
    read_scene()
    assert not asked
    read_scene(report=ReadReport())
    assert sorted(asked) == ["report_losses", "report_losses", "report_scene_losses"]


def test_nothing_is_told_of_what_the_startup_file_has() -> None:
    """Nobody has set anything there: a warning would only frighten."""
    bpy.ops.wm.read_factory_settings(use_empty=False)
    assert losses() == []
    nodes = bpy.context.scene.world.node_tree.nodes
    nodes["Background"].inputs["Strength"].default_value = 3
    bpy.data.objects["Camera"].color = (1, 0, 0, 1)
    bpy.data.objects["Cube"].display_type = "WIRE"
    told = losses()
    assert [text.split(" that")[0] for text in told] == ["settings", "settings", "the world 'World' is not read"]
