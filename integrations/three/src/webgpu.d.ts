// Types of parbake-three-parallax/webgpu, for TypeScript and editors.
import type { Material, MeshStandardMaterial, Node, Object3D, Texture } from 'three/webgpu';
import type { MeshPhysicalNodeMaterial, MeshStandardNodeMaterial } from 'three/webgpu';
import type { GLTFLoaderPlugin, GLTFParser, GLTF } from 'three/examples/jsm/loaders/GLTFLoader.js';
import type { ApplyOptions, Parallax, ParallaxMaps, PluginOptions } from './index.js';

export { ParallaxMaps } from './index.js';
export type { ApplyOptions, ParallaxLayers, PluginOptions } from './index.js';

/** `loader.register((parser) => new ParallaxNodePlugin(parser))` */
export class ParallaxNodePlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: PluginOptions);
  readonly name: 'PARBAKE_materials_parallax';
  beforeRoot(): null;
  loadMaterial(materialIndex: number): Promise<Material> | null;
  afterRoot(result: GLTF): null;
}

/** What a node material with maps has as `material.parallax`. */
export interface NodeParallax extends Parallax {
  /** Makes the material's nodes anew: after one of its textures was exchanged. */
  update(): void;
}

export type ParallaxNodeMaterial = (MeshStandardNodeMaterial | MeshPhysicalNodeMaterial) & { parallax: NodeParallax };

/** A node material with maps in the place of a lit material, without GLTFLoader. */
export function parallaxNodeMaterial(
  material: MeshStandardMaterial | MeshStandardNodeMaterial, maps: ParallaxMaps, options?: ApplyOptions,
): ParallaxNodeMaterial;

/** Lets geometries below an object that have vertex offsets follow the switches of their materials. The plug-in does so by itself. */
export function followSwitches(root: Object3D): void;

/** All materials below an object that have maps. */
export function parallaxMaterials(root: Object3D): ParallaxNodeMaterial[];

/** Switches the maps of all materials below an object. */
export function setParallax(root: Object3D, isOn: boolean): void;

/** The formulas of the format as functions of nodes. */
export const parallaxNodes: {
  line(toViewer: Node, frame: [Node, Node, Node]): Node;
  shift(pairs: [Node, Node], line: Node, limit: number): Node;
  opacity(coefficients: [Node, Node, Node], line: Node): Node;
  fade(dx: Node, dy: Node, z: Node, footprint: number): Node;
  coefficients(image: Texture, at: Node, rows: Node, scale: Node[], offset: Node[]): Node[];
  derivedFrame(normal: Node, position: Node, uv: Node): [Node, Node, Node];
  vertexFrame(normal: Node, tangent: Node, side: Node): [Node, Node, Node];
};
