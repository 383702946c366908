"""The sidebar tab "UniSG" in the 3D viewport."""

from __future__ import annotations

import bpy


class UNISG_PT_main(bpy.types.Panel):
    """The tab itself; everything else hangs under it."""

    bl_idname = "UNISG_PT_main"
    bl_label = "UniSG"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "UniSG"

    def draw(self, context: bpy.types.Context) -> None:
        scene = context.scene
        self.layout.label(text=f"{len(scene.objects)} objects in {scene.name!r}", icon="SCENE_DATA")


CLASSES = (UNISG_PT_main,)
