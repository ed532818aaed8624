// Types of the package, for TypeScript and editors.
import type {
  BufferGeometry, Material, MeshDepthMaterial, MeshDistanceMaterial, MeshStandardMaterial, Object3D, Texture,
} from 'three';
import type { GLTFLoaderPlugin, GLTFParser, GLTF } from 'three/examples/jsm/loaders/GLTFLoader.js';

export interface ParallaxOptions {
  /**
   * Smooth borders of cutouts where a target has several samples a pixel, by alpha to coverage. Default true. Choose
   * false where the alpha of what is drawn is used: there it is that of the border, not 1.
   */
  alphaToCoverage?: boolean;
}

export interface PluginOptions extends ParallaxOptions {
  /** Also load the textures for viewers without the maps, which are shown while these are switched off. Default false. */
  fallback?: boolean;
}

export interface ApplyOptions extends ParallaxOptions {
  /** What slots of the material hold while the maps are switched off. */
  fallback?: { map?: Texture | null; normalMap?: Texture | null };
}

/** `loader.register((parser) => new ParallaxPlugin(parser))` */
export class ParallaxPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: PluginOptions);
  readonly name: 'PARBAKE_materials_parallax';
  beforeRoot(): null;
  loadMaterial(materialIndex: number): Promise<Material> | null;
  afterRoot(result: GLTF): null;
}

/** What a material with maps has as `material.parallax`. */
export interface Parallax {
  /** Switches shift and cutout; shadows follow. */
  enabled: boolean;
  /** The images of coefficients and textures that are not shown now. Dispose of them with the material's own textures. */
  readonly textures: Texture[];
}

export type ParallaxMaterial = MeshStandardMaterial & { parallax: Parallax };

/** Coefficients of one image, whose layers lie one below the other. */
export interface ParallaxLayers {
  /** Linear, clamped, without mip levels, `flipY` false. */
  texture: Texture;
  /** One for each channel: 8 of the shift, 12 of the cutout. */
  scale: number[];
  offset: number[];
}

/** The maps of one or more materials. Throws if an image has other layers. */
export class ParallaxMaps {
  constructor(maps: ParallaxLayers & { limit?: number; fadeFootprint?: number; cutout?: ParallaxLayers | null });
  readonly textures: Texture[];
  readonly hasCutout: boolean;
}

/** Gives a material maps, without GLTFLoader. Returns the material. */
export function applyParallax<M extends MeshStandardMaterial>(
  material: M, maps: ParallaxMaps, options?: ApplyOptions,
): M & { parallax: Parallax };

/**
 * Lets another material of the same geometries, such as one that draws their edges, stand where maps are shown. The
 * function that comes back switches that.
 */
export function followOffsets(material: Material): (isOn: boolean) => void;

/** All materials below an object that have maps. */
export function parallaxMaterials(root: Object3D): ParallaxMaterial[];

/** Switches the maps of all materials below an object. */
export function setParallax(root: Object3D, isOn: boolean): void;

/** Gives meshes below an object materials for shadows, where they are cut out. The plug-in does so by itself. */
export function addShadowMaterials(root: Object3D): void;

/** A material for depth passes of a mesh that is cut out, such as a prepass. */
export function createDepthMaterial(
  material: ParallaxMaterial, geometry: BufferGeometry, options?: { isDistance?: boolean },
): MeshDepthMaterial | MeshDistanceMaterial;

/** The formulas of the format as functions of GLSL ES 3.00. */
export const PARALLAX_GLSL: string;
