"""The component tables that rooms share, by name, with their columns.

Every table is sparse (see :class:`~.graph.Table`): ``rows`` int32 (K,) says which
entity each entry belongs to. Matrices are float64 with column vectors, lengths in
metres, angles in radians. References to entities are uids. ``object`` columns
hold Python values.

The tables ``actions``, ``lsa``, ``relations`` and ``properties`` come from the
custom properties; :func:`~.properties.property_tables` makes them.
"""

from __future__ import annotations

ACTIONS = "actions"
"""``data`` object: :class:`~.action_data.ActionData`; several per entity."""

LSA = "lsa"
"""``data`` object: :class:`~.lesson_node.LessonNode`, the root of an operation."""

RELATIONS = "relations"
"""``kind`` object (str), ``target`` object (str, uid); several per entity."""

PROPERTIES = "properties"
"""``json`` object (str): all other custom properties, one JSON object per entity."""

WORLD = "world"
"""``matrix`` (K, 4, 4): the evaluated world matrix of entities that constraints, physics, a curve to
follow or anything else move away from where ``local`` puts them."""

PARENTING = "parenting"
"""Entities that hang on a part of their parent. ``kind`` object (str): "BONE", "VERTEX", "VERTEX_3",
"ARMATURE" or "LATTICE"; ``bone`` object (str): name of the bone, "" for none; ``vertices`` int32 (K, 3):
numbers of the parent's vertices; ``frame`` (K, 4, 4): that part's frame to the parent's frame, which
``local`` contains already: local = frame @ parent inverse @ basis."""

CHANNELS = "channels"
"""How Blender spells ``local`` where this is more than location, XYZ Euler angles and scale. ``mode``
object (str): "QUATERNION", "AXIS_ANGLE" or an Euler order such as "XYZ"; ``location`` (K, 3);
``rotation`` (K, 4): Euler angles x, y, z and 0, or quaternion w, x, y, z, or angle and axis x, y, z;
``scale`` (K, 3); ``delta_location`` (K, 3), ``delta_rotation`` (K, 4) like ``rotation``, ``delta_scale``
(K, 3); ``inverse`` (K, 4, 4): the parent inverse. ``local`` is what counts: who changes it may leave this
table alone, a writer uses it only where both agree."""

COLLECTIONS = "collections"
"""``path`` object (tuple of str): names of the collections from the outermost inwards, the scene's own left
out; several per entity if it is in several collections. Entities directly in the scene have none."""

VISIBILITY = "visibility"
"""Entities that are hidden in some way. bool columns: ``hidden`` (the eye), ``viewport`` (disabled in
viewports), ``render`` (disabled in renders)."""

MATERIALS = "materials"
"""Materials of the entity that replace those of its shared mesh: ``slot`` int32, ``material`` object (str, ""
for an empty slot)."""

CAMERA = "camera"
"""``data`` object (str): name of the shared camera data; ``kind`` object (str): "PERSP", "ORTHO" or "PANO";
``active`` bool: the scene's camera; ``fit`` object (str): "AUTO", "HORIZONTAL" or "VERTICAL"; float64: ``lens``,
``sensor_width`` and ``sensor_height`` in millimetres, ``ortho_scale``, ``clip_start``, ``clip_end`` in metres,
``shift_x``, ``shift_y`` in sensor sizes. Depth of field: ``focused`` bool, ``focus_distance`` in metres, ``fstop``. It
looks along -Z with +Y up."""

LIGHT = "light"
"""``data`` object (str): name of the shared light data; ``kind`` object (str): "POINT", "SUN", "SPOT" or "AREA";
``color`` float64 (K, 3) linear; ``shape`` object (str): "SQUARE", "RECTANGLE", "DISK" or "ELLIPSE" of an area
light, else ""; float64: ``energy`` in watts (a sun: watts per square metre), ``radius``, ``size``, ``size_y`` in
metres, ``angle`` of a sun, ``spot_size`` and ``spread`` (of an area) in radians, ``spot_blend`` 0..1, ``diffuse`` and
``specular`` factors, ``exposure`` in stops, ``temperature`` in kelvin; bool: ``shadow``, ``normalize`` (``energy`` is
independent of the size), ``tinted`` (by the temperature). It shines along -Z."""

BONES = "bones"
"""The bones of armatures, parents first. ``name`` object (str); ``parent`` object (str, "" for a root); ``rest``
and ``pose`` (K, 4, 4): bone frame to armature frame, in rest and as posed; ``length`` float64; ``connected``,
``deform`` and ``relative`` (children hang at the head and follow the scale) bool."""

EMPTY = "empty"
"""How empties are drawn where it is not plain axes of size 1: ``display`` object (str), ``size`` float64."""

INSTANCES = "instances"
"""Copies that are drawn but are no entities. ``prototype`` object: a whole :class:`~.graph.SceneGraph`, the same
object for every entry that instances the same object, its meshes shared with other graphs; it may have instances
itself; ``matrix`` (K, 4, 4): prototype's world to the frame of the entity; ``source`` object (str): "COLLECTION"
for a whole collection, "GEOMETRY" for what geometry nodes, particles or duplication make; several per entity.
:func:`~.realize_instances.realize` turns them into entities."""

ANIMATION = "animation"
"""Motion. ``times`` object (float64 (T,)): seconds, ascending; ``matrices`` object (float64 (T, 4, 4)):
the local matrix at these times (child to parent); one entry per moving entity."""

RECORDING = "recording"
"""Motion that was recorded while a user moved objects: columns as in :data:`ANIMATION`."""

LIBRARY = "library"
"""Entities that come from another file: ``path`` object (str) as the file has it."""

EVENTS = "events"
"""What happened while a recording was made. ``time`` float64: seconds; ``event`` object (str): one word; ``action``
object (str): uid of the action that it is about. Rows are the entities that the actions belong to: "started",
"performed", "skipped", "early" (before its turn), "failed" (a wrong answer), "answered:0,2" (positions chosen); or
tools: "pressed" and "released" (the trigger), "force:5" (newtons), with ``action`` "". Several per entity."""

JOINTS = "joints"
"""How entities can move against their parents, several per entity. ``name`` object (str); ``kind`` object (str):
"revolute", "prismatic", "ball" or "free"; in the entity's frame ``axis`` (K, 3), a direction, and ``anchor`` (K, 3), a
point on it; float64 ``low`` and ``high``: radians or metres from where the entity stands, infinite without a limit."""

RIGID_BODIES = "rigid_bodies"
"""What a simulator takes an entity for. ``kind`` object (str): "active" moves, "passive" does not; ``shape`` object
(str), what collides: "box", "hull" (of each mesh), "mesh", "sphere", "capsule", "cylinder" or "cone"; float64: ``mass``
in kilograms, ``friction`` and ``restitution``. Meshes under an entity without an entry of their own are of its body."""
