// Where three.js has the vertices of a skinned mesh: three.mjs NODE_MODULES FILE.glb TIMES OUT, TIMES a JSON list of seconds.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, file, times, out] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(path.resolve(modules, 'three', name)).href);
const THREE = await load('build/three.module.js');
const { GLTFLoader } = await load('examples/jsm/loaders/GLTFLoader.js');

const bytes = fs.readFileSync(file);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const gltf = await new GLTFLoader().parseAsync(buffer, '');
const mixer = new THREE.AnimationMixer(gltf.scene);
mixer.clipAction(gltf.animations[0]).play();
let mesh = null;
gltf.scene.traverse((object) => {
  if (object.isSkinnedMesh) mesh ??= object;
});
const at = new THREE.Vector3();
const found = JSON.parse(times).map((seconds) => {
  // The last key is where the animation begins anew.
  mixer.setTime(Math.min(seconds, gltf.animations[0].duration - 1e-6));
  gltf.scene.updateMatrixWorld(true);
  const count = mesh.geometry.attributes.position.count;
  return Array.from({ length: count }, (_, i) => mesh.localToWorld(mesh.getVertexPosition(i, at)).toArray());
});
fs.writeFileSync(out, JSON.stringify(found));
