"""What the text and the JSON schema of KHR_interactivity ask of a graph, as far as lessons use it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

WIDTHS = {
    "bool": 1,
    "int": 1,
    "float": 1,
    "float2": 2,
    "float3": 3,
    "float4": 4,
    "float3x3": 9,
    "float4x4": 16,
    "ref": 1,
}
SAME = {"math/add", "math/sub", "math/mul", "math/max", "math/abs", "math/normalize", "math/sqrt", "math/cross",
        "math/and", "math/or", "math/not", "math/transform", "math/quatMul", "math/quatConjugate"}  # fmt: skip
"""Operations that give what their input ``a`` is."""

FIXED = {"math/le": "bool", "math/gt": "bool", "math/eq": "bool", "math/dot": "float", "math/length": "float",
         "math/combine3": "float3", "math/combine4": "float4"}  # fmt: skip
SOCKETS = {"flow/branch": {"condition"}, "flow/while": {"condition"}, "math/combine3": {"a", "b", "c"},
           "pointer/interpolate": {"n", "value", "duration", "p1", "p2"},
           "math/combine4": {"a", "b", "c", "d"}}  # fmt: skip
UNARY = {"math/abs", "math/normalize", "math/sqrt", "math/not", "math/length", "math/quatConjugate"}


def broken_rules(graph: Mapping[str, Any], nodes: int) -> list[str]:
    """What is wrong with a graph of an asset with so many nodes; [] for nothing."""
    return [*_tables(graph), *(text for place in range(len(graph["nodes"])) for text in _node(graph, place, nodes))]


def _tables(graph: Mapping[str, Any]) -> Iterator[str]:
    if set(graph) - {"types", "variables", "events", "declarations", "nodes"}:
        yield "the graph has unknown parts"
    signatures = [each["signature"] for each in graph["types"]]
    if len(set(signatures)) != len(signatures) or set(signatures) - set(WIDTHS):
        yield f"the types are {signatures}"
    for name in ("variables", "events", "declarations", "nodes", "types"):
        if name in graph and not graph[name]:
            yield f"{name} are an empty list"
    for place, variable in enumerate(graph.get("variables", ())):
        if not _fits(graph, variable):
            yield f"variable {place} has a value of another type"
    if len({each["id"] for each in graph.get("events", ())}) != len(graph.get("events", ())):
        yield "two events share an id"
    if any(set(each) != {"op"} for each in graph["declarations"] if each["op"] != "event/onSelect"):
        yield "a declaration has more than its operation"


def _fits(graph: Mapping[str, Any], inline: Mapping[str, Any]) -> bool:
    kind, value = graph["types"][inline["type"]]["signature"], inline["value"]
    wanted = {"bool": (bool,), "int": (int,)}.get(kind, (int, float))  # a whole number is written without a fraction
    return len(value) == WIDTHS[kind] and all(type(number) in wanted for number in value)


def _node(graph: Mapping[str, Any], place: int, nodes: int) -> Iterator[str]:
    node = graph["nodes"][place]
    op = graph["declarations"][node["declaration"]]["op"]
    where = f"node {place} ({op})"
    if set(node) - {"declaration", "configuration", "values", "flows"} or any(
        not node[key] for key in set(node) - {"declaration"}
    ):
        yield f"{where} has unknown or empty parts"
    for name, source in node.get("values", {}).items():
        if "node" in source:
            if not 0 <= source["node"] < place or set(source) - {"node", "socket"}:
                yield f"{where}: {name} comes from {source}"
        elif not _fits(graph, source):
            yield f"{where}: {name} has a value of another type"
    for name, flow in node.get("flows", {}).items():
        if not place < flow["node"] < len(graph["nodes"]):
            yield f"{where}: the flow {name} goes back"
    yield from (f"{where}: {text}" for text in _operation(graph, node, op, nodes))


def _operation(graph: Mapping[str, Any], node: Mapping[str, Any], op: str, nodes: int) -> Iterator[str]:
    values = set(node.get("values", {}))
    setting = {name: each["value"] for name, each in node.get("configuration", {}).items()}
    kinds = {name: _kind(graph, source) for name, source in node.get("values", {}).items()}
    if op.startswith("math/"):
        wanted = SOCKETS.get(op, {"a"} if op in UNARY else {"a", "b"})
        if values != wanted:
            yield f"the inputs are {values}"
        if op not in ("math/transform", "math/combine3", "math/combine4") and len(set(kinds.values())) != 1:
            yield f"its inputs are of different types: {kinds}"
    elif op in SOCKETS and values != SOCKETS[op]:
        yield f"the inputs are {values}"
    elif op == "variable/set":
        if values != set(map(str, setting["variables"])) or len(set(setting["variables"])) != len(setting["variables"]):
            yield f"it sets {values}, and says {setting}"
        for name, kind in kinds.items():
            if kind != graph["types"][graph["variables"][int(name)]["type"]]["signature"]:
                yield f"the variable {name} is set to a {kind}"
    elif op == "event/send":
        event = graph["events"][setting["event"][0]]
        if kinds != {name: graph["types"][each["type"]]["signature"] for name, each in event["values"].items()}:
            yield f"it sends {kinds}"
    elif op == "event/onSelect" and not 0 <= setting["nodeIndex"][0] < nodes:
        yield "it waits for a node that is not there"
    elif op.startswith("pointer/") and "[n]" not in setting["pointer"][0] and not _pointed(setting) < nodes:
        yield "it points to a node that is not there"


def _pointed(setting: Mapping[str, Any]) -> int:
    return int(setting["pointer"][0].split("/")[2])


def _kind(graph: Mapping[str, Any], source: Mapping[str, Any]) -> str:
    """The type of what a socket gets."""
    if "node" not in source:
        return str(graph["types"][source["type"]]["signature"])
    node = graph["nodes"][source["node"]]
    op = graph["declarations"][node["declaration"]]["op"]
    setting = {name: each["value"][0] for name, each in node.get("configuration", {}).items()}
    if op in FIXED:
        return FIXED[op]
    if op in SAME:
        return _kind(graph, node["values"]["a"])
    if op == "variable/get":
        return str(graph["types"][graph["variables"][setting["variable"]]["type"]]["signature"])
    if op == "pointer/get":
        return str(graph["types"][setting["type"]]["signature"])
    if op == "event/onTick":
        return "float"
    assert op == "event/receive", op
    return str(graph["types"][graph["events"][setting["event"]]["values"][source["socket"]]["type"]]["signature"])
