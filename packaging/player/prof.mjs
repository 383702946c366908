globalThis.XMLHttpRequest=class{open(){}send(){}};
import {NullEngine} from "@babylonjs/core/Engines/nullEngine.js";
import {Scene} from "@babylonjs/core/scene.js";
import {FreeCamera} from "@babylonjs/core/Cameras/freeCamera.js";
import {Vector3} from "@babylonjs/core/Maths/math.vector.js";
import {LoadAssetContainerAsync} from "@babylonjs/core/Loading/sceneLoader.js";
import {FlowGraphCoordinator} from "@babylonjs/core/FlowGraph/flowGraphCoordinator.js";
import {FlowGraphContext} from "@babylonjs/core/FlowGraph/flowGraphContext.js";
import "@babylonjs/loaders/glTF/2.0/index.js";
import fs from "fs";
const engine=new NullEngine(); const scene=new Scene(engine); new FreeCamera("c",new Vector3(0,0,-5),scene);
const c=await LoadAssetContainerAsync(new Uint8Array(fs.readFileSync(process.argv[2])),scene,{pluginExtension:".glb"});
c.addAllToScene();
for (const m of scene.meshes) m.isVisible=false;
const coord=FlowGraphCoordinator.SceneCoordinators.get(scene)?.[0];
for(let i=0;i<20;i++){engine.beginFrame();scene.render();engine.endFrame();}
// time the observers only
let total=0, n=0; 
const obs=scene.onBeforeRenderObservable.observers; console.log("observers",obs.length);
let t0; scene.onBeforeRenderObservable.add(()=>{t0=performance.now()},-1,true); scene.onBeforeRenderObservable.add(()=>{total+=performance.now()-t0;n++});
const t2=performance.now(); const N=Number(process.argv[3]??300);
for(let i=0;i<N;i++){engine.beginFrame();scene.render();engine.endFrame();}
console.log("ms/frame",(performance.now()-t2)/N,"ms/tick",total/n);
