"""Takes the behaviour of one object out of a scene, as if nobody had written it yet."""

from __future__ import annotations

from dataclasses import replace

from ...behaviour.lesson.edit import without_leaves
from ...generate.behaviour.roled_actions import read_roled_actions
from ...scene import ActionData, SceneGraph, entry_table
from ...scene.identity import derived_uid


def without_behaviour(graph: SceneGraph, row: int) -> tuple[SceneGraph, str]:
    """The scene without the actions in which the object at ``row`` takes part, and the object's new uid.

    Their leaves go, and parts of the lesson that hold nothing more; groups lose them as
    members; a group that the object carried is carried by what carries its first
    member left; relations and parents stay.
    """
    old, uid = graph.uid[row], derived_uid(graph.uid[row], "again")
    roled_actions = read_roled_actions(graph)
    gone = {roled.action.uid for roled in roled_actions if row in roled.slots}
    owners = {roled.action.uid: roled.owner for roled in roled_actions}
    actions = []
    for owner, action in graph.entries("actions", "data"):
        if action.uid in gone:
            continue
        if action.type == "Parallel":
            action = replace(action, members=tuple(member for member in action.members if member not in gone))
            if not action.members:
                gone.add(action.uid)
                continue
            owner = owners.get(action.members[0], owner) if owner == row else owner
        actions.append((owner, _renamed(action, old, uid)))
    trees = [(above, without_leaves(tree, gone)) for above, tree in graph.entries("lsa", "data")]
    relations = graph.entries("relations", "kind", "target")
    bare = graph.with_component("actions", entry_table(actions, "data"))
    bare = bare.with_component("lsa", entry_table([entry for entry in trees if entry[1].children], "data"))
    said = [(subject, kind, uid if target == old else target) for subject, kind, target in relations]
    bare = bare.with_component("relations", entry_table(said, "kind", "target"))
    return bare.replace(uid=(*bare.uid[:row], uid, *bare.uid[row + 1 :])), uid


def _renamed(action: ActionData, old: str, uid: str) -> ActionData:
    return replace(action, frame=uid) if action.frame == old else action
