// Babylon's strict check of behaviour graphs: node validate_graphs.mjs GRAPHS.json; prints how many it finds fault with.
// The file is a list of {extension: of the document, nodes: how many the asset has}.
import fs from "node:fs";
import { CreateKHRInteractivityDocument } from "@babylonjs/loaders/glTF/2.0/Extensions/KHR_interactivity/interactivityGraphModel.js";
import "@babylonjs/loaders/glTF/2.0/index.js";

const known = new Set(["KHR_interactivity", "KHR_node_selectability"]);
const faults = [];
for (const { extension, nodes } of JSON.parse(fs.readFileSync(process.argv[2]))) {
  for (const graph of CreateKHRInteractivityDocument(extension, known, nodes).graphs) {
    if (graph.diagnostics.length || !graph.valid) faults.push(graph.diagnostics[0] ?? "invalid");
  }
}
console.log(JSON.stringify({ faults: faults.length, first: faults[0] ?? null }));
process.exit(0);
