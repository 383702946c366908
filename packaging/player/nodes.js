// The nodes of a glTF file by their numbers, and where they stand.
import { Matrix, Quaternion, Vector3 } from "@babylonjs/core/Maths/math.vector.js";

export function byNumber(container) {
  const nodes = [];
  for (const node of [...container.transformNodes, ...container.meshes]) {
    for (const pointer of node._internalMetadata?.gltf?.pointers ?? []) {
      const found = /^\/nodes\/(\d+)$/.exec(pointer);
      if (found) nodes[Number(found[1])] ??= node;
    }
  }
  return nodes;
}

export const worldOf = (node) => (node ? node.computeWorldMatrix(true) : Matrix.Identity());

export function parts(matrix) {
  const rotation = new Quaternion(), position = new Vector3();
  matrix.decompose(undefined, rotation, position);
  return { rotation, position };
}

// Put a node where a matrix of the world says, with the size that it has.
export function place(node, matrix) {
  const local = node.parent ? matrix.multiply(Matrix.Invert(worldOf(node.parent))) : matrix;
  const { rotation, position } = parts(local);
  node.position.copyFrom(position);
  node.rotationQuaternion = rotation;
  node.computeWorldMatrix(true);
}
