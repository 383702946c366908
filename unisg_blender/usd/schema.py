"""Names in the master file; docs/usd.md describes it."""

from __future__ import annotations

VERSION = 1

# attributes of the scene's prim
SCENE_VERSION = "unisg:version"
FRAME = "unisg:frame"

# attributes and relationships of an entity's prim
UID = "unisg:uid"
TYPE = "unisg:type"
CATEGORY = "unisg:category"
LABELS = "semantics:labels:category"
INFO = "unisg:info"
LOCAL = "unisg:local"
WORLD = "unisg:world"
ACTIONS = "unisg:actions"
LSA = "unisg:lsa"
TARGETS = "unisg:targets"
TOOLS = "unisg:tools"
RELATION = "unisg:relation:"
RELATIONS = "unisg:relations"
PROPERTIES = "unisg:properties"
USER = "userProperties:"

# attributes of a mesh, of a part of it, of a component table
MATERIALS = "unisg:materials"
EDGES = "unisg:edges"
SLOT = "unisg:slot"
ENTITIES = "unisg:entities"
COLUMN = "unisg:column:"
LAYOUT = "unisg:columns"

# scopes under the scene's prim
MATERIAL_SCOPE = "_materials"
MESH_SCOPE = "_meshes"
COMPONENT_SCOPE = "_components"
PROTOTYPE_SCOPE = "_prototypes"
SCOPES = (MATERIAL_SCOPE, MESH_SCOPE, COMPONENT_SCOPE, PROTOTYPE_SCOPE)

TRANSFORM = "xformOp:transform"
RESET = "!resetXformStack!"

# motion beside the transform's own time samples
RECORDING = "unisg:recording"
RECORDED = "unisg:recorded"
EVENTS = "unisg:events"

# native instances and point instancers that stand for the component "instances"
SOURCE = "unisg:source"
MATRICES = "unisg:matrices"
