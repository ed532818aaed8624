// All of three.js that the page uses, built into a file of its own: it changes only with three.js's version.
export {
  AnimationMixer, BackSide, Box3, BufferAttribute, BufferGeometry, ClampToEdgeWrapping, Color, CustomBlending,
  DataTexture, DirectionalLight, DoubleSide, EqualDepth, FloatType, Group, HalfFloatType, LinearFilter, LinearSRGBColorSpace, LineSegments,
  LoadingManager, Matrix3, MaxEquation, Mesh, MeshBasicMaterial, MeshDepthMaterial, MeshDistanceMaterial,
  NearestFilter, NoColorSpace, OneFactor, OrthographicCamera, PerspectiveCamera, PlaneGeometry, PMREMGenerator,
  RGFormat, Scene, ShaderChunk, ShaderMaterial, SphereGeometry, SRGBColorSpace, UnsignedByteType, Vector2, Vector3,
  Vector4, WebGLRenderer, WebGLRenderTarget, ZeroFactor,
} from 'three';
export { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
export { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
export { KTX2Loader } from 'three/examples/jsm/loaders/KTX2Loader.js';
export { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';
export { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';
