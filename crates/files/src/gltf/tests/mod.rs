//! Reading glTF: tiny documents made by hand.

mod compressed;
mod extensions;
mod motion;
mod painted;
mod parallax;
mod textures;
mod writing;

use super::*;
use crate::NoResources;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

fn read_value(document: &Value) -> Result<Loaded, String> {
    read_limited(document, &Limits::default())
}

fn read_limited(document: &Value, limits: &Limits) -> Result<Loaded, String> {
    let text = document.to_string();
    read_gltf_bytes(Path::new("x/a.gltf"), text.as_bytes(), &NoResources, limits).map_err(|e| e.to_string())
}

fn hex_uri(bytes: &[u8]) -> String {
    let hex: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:application/octet-stream,{hex}")
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A document with the triangle (0,0,0) (1,0,0) (0,1,0), or other positions.
fn document(positions: &[f32]) -> Value {
    let bytes = floats(positions);
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": positions.len() / 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "buffers": [{ "byteLength": bytes.len(), "uri": hex_uri(&bytes) }],
    })
}

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Adds an accessor with a buffer of its own; its index is returned.
fn add(document: &mut Value, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
    let push = |list: &mut Value, value: Value| {
        let list = list.as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    };
    let length = bytes.len();
    let buffer = push(&mut document["buffers"], json!({ "byteLength": length, "uri": hex_uri(bytes) }));
    let view = push(&mut document["bufferViews"], json!({ "buffer": buffer, "byteLength": length }));
    push(
        &mut document["accessors"],
        json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
    )
}

/// Protects the smallest document, and each way of naming what to show.
#[test]
fn scenes_and_roots() {
    let mut document = document(&TRIANGLE);
    let loaded = read_value(&document).unwrap();
    assert_eq!(loaded.model.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((loaded.model.name.as_str(), loaded.model.materials.len()), ("a", 1));
    assert_eq!(loaded.warnings, [""; 0]);
    document["scenes"] = json!([]);
    document["nodes"] = json!([{ "children": [1] }, { "mesh": 0 }, { "mesh": 0 }]);
    assert_eq!(read_value(&document).unwrap().model.mesh.triangles.len(), 2);
    document["nodes"] = json!([]);
    assert_eq!(read_value(&document).unwrap().model.mesh.triangles.len(), 1);
    document["scene"] = json!(3);
    document["nodes"] = json!([{ "mesh": 0 }]);
    assert!(read_value(&document).unwrap_err().contains("/scene: scene 3"));
}

/// Protects transforms: parent times child, TRS and matrix, and mirrors.
#[test]
fn nodes_place_meshes() {
    let mut document = document(&TRIANGLE);
    let normals = add(&mut document, "VEC3", 5126, 3, &floats(&[0.6, 0.0, 0.8].repeat(3)));
    let tangents = add(&mut document, "VEC4", 5126, 3, &floats(&[0.8, 0.0, -0.6, 1.0].repeat(3)));
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    document["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = tangents.into();
    let half = 0.5f64.sqrt();
    document["nodes"] = json!([
        { "translation": [0, 0, 5], "scale": [-2, 1, 1], "children": [1] },
        { "rotation": [0, 0, half, half], "mesh": 0 },
    ]);
    let mesh = read_value(&document).unwrap().model.mesh;
    // X goes to Y by the turn; Y goes to −X, and by the mirror to 2 X.
    assert!(mesh.positions[1].distance(Vec3::new(0.0, 1.0, 5.0)) < 1e-6);
    assert!(mesh.positions[2].distance(Vec3::new(2.0, 0.0, 5.0)) < 1e-6);
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
    assert!(mesh.area_normal(0).z > 0.0, "the front stays in front");
    assert!(mesh.normals[0].distance(Vec3::new(0.0, 0.6, 0.8)) < 1e-6, "{}", mesh.normals[0]);
    assert!(mesh.tangents[0].distance(Vec4::new(0.0, 0.8, -0.6, -1.0)) < 1e-6);
    document["nodes"] = json!([{ "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1] }]);
    assert_eq!(read_value(&document).unwrap().model.mesh.positions[0], Vec3::new(7.0, 8.0, 9.0));
}

/// Protects against hierarchies that are no forest.
#[test]
fn cycles_and_two_parents_are_refused() {
    for (nodes, place) in [
        (json!([{ "children": [0] }]), "/nodes/0/children/0"),
        (json!([{ "children": [1] }, { "children": [0] }]), "/nodes/1/children/0"),
        (json!([{ "children": [1, 2] }, { "children": [2] }, {}]), "/nodes/0/children/1"),
        (json!([{ "children": [9] }]), "/nodes/0/children/0"),
    ] {
        let mut document = document(&TRIANGLE);
        document["nodes"] = nodes;
        let error = read_value(&document).unwrap_err();
        assert!(error.contains(place), "{error}");
    }
}

/// Protects strips, fans, index types and the passing over of lines.
#[test]
fn modes_and_indices() {
    let mut document = document(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.]);
    let indices = add(&mut document, "SCALAR", 5121, 4, &[0, 1, 2, 3]);
    document["meshes"][0]["primitives"][0]["indices"] = indices.into();
    let mut triangles = |mode: u32| {
        document["meshes"][0]["primitives"][0]["mode"] = mode.into();
        read_value(&document).map(|loaded| loaded.model.mesh.triangles)
    };
    assert_eq!(triangles(5).unwrap(), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(triangles(6).unwrap(), [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(triangles(4).unwrap(), [[0, 1, 2]]);
    assert!(triangles(1).unwrap_err().contains("no triangles"));
    assert!(triangles(7).unwrap_err().contains("/meshes/0/primitives/0/mode"));
    let bad = add(&mut document, "SCALAR", 5123, 3, &[0, 0, 1, 0, 4, 0]);
    document["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 }, "indices": bad });
    let error = read_value(&document).unwrap_err();
    assert!(error.contains(&format!("/accessors/{bad}, element 2: index 4")), "{error}");
}

/// Protects quantised attributes and colours of three components.
#[test]
fn integers_are_normalised() {
    let mut document = document(&TRIANGLE);
    let uvs = add(&mut document, "VEC2", 5123, 3, &[0, 0, 255, 255, 10, 0, 0, 0, 0, 0, 0, 0]);
    document["accessors"][uvs]["normalized"] = true.into();
    let colors = add(&mut document, "VEC3", 5121, 3, &[255, 0, 51, 0, 0, 0, 0, 0, 0]);
    document["accessors"][colors]["normalized"] = true.into();
    let normals = add(&mut document, "VEC3", 5120, 3, &[0, 0, 127, 0, 0, 127, 0, 0, 128]);
    document["accessors"][normals]["normalized"] = true.into();
    document["meshes"][0]["primitives"][0]["attributes"] =
        json!({ "POSITION": 0, "TEXCOORD_0": uvs, "COLOR_0": colors, "NORMAL": normals });
    let mesh = read_value(&document).unwrap().model.mesh;
    assert_eq!(mesh.uvs[..2], [Vec2::new(0.0, 1.0), Vec2::new(10.0 / 65535.0, 0.0)]);
    assert_eq!(mesh.colors[0], Vec4::new(1.0, 0.0, 0.2, 1.0));
    assert_eq!(mesh.normals[2], Vec3::NEG_Z);
    document["accessors"][uvs]["normalized"] = false.into();
    assert_eq!(read_value(&document).unwrap().model.mesh.uvs[1], Vec2::new(10.0, 0.0));
}

/// Protects strides, offsets and sparse replacements, also of nothing.
#[test]
fn accessors_may_be_strided_and_sparse() {
    let interleaved = [9., 0., 0., 0., 9., 1., 0., 0., 9., 0., 1., 0.];
    let mut doc = document(&interleaved);
    doc["accessors"][0] =
        json!({ "bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 3, "type": "VEC3" });
    doc["bufferViews"][0]["byteStride"] = 16.into();
    assert_eq!(read_value(&doc).unwrap().model.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    doc["bufferViews"][0]["byteStride"] = 8.into();
    assert!(read_value(&doc).unwrap_err().contains("overlap at a stride of 8"));
    let mut sparse = document(&TRIANGLE);
    let indices = add(&mut sparse, "SCALAR", 5121, 2, &[1, 2]);
    let values = add(&mut sparse, "VEC3", 5126, 2, &floats(&[3., 0., 0., 0., 4., 0.]));
    sparse["accessors"][0] = json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 2, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values } } });
    let mesh = read_value(&sparse).unwrap().model.mesh;
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 4.0]);
    sparse["accessors"][0]["count"] = 2.into();
    let error = read_value(&sparse).unwrap_err();
    assert!(error.contains("/accessors/0/sparse/indices: sparse index 2"), "{error}");
}

/// Protects memory: declared counts must be borne out by bytes, or by the limits.
#[test]
fn absurd_counts_are_refused() {
    let mut doc = document(&TRIANGLE);
    doc["accessors"][0]["count"] = 4_000_000_000u64.into();
    assert!(read_value(&doc).unwrap_err().contains("reach beyond the 36 bytes"));
    doc["accessors"][0]["count"] = u64::MAX.into();
    assert!(read_value(&doc).is_err());
    doc["accessors"][0] = json!({ "componentType": 5126, "count": 4_000_000_000u64, "type": "VEC3" });
    assert!(read_value(&doc).unwrap_err().contains("/accessors/0/count"));
    let mut instances = document(&TRIANGLE);
    instances["nodes"] = json!(vec![json!({ "mesh": 0 }); 10]);
    instances["scenes"] = json!([{ "nodes": (0..10).collect::<Vec<_>>() }]);
    let limits = Limits { max_triangles: 9, ..Limits::default() };
    assert!(read_limited(&instances, &limits).unwrap_err().contains("triangles: 10"));
    let limits = Limits { max_vertices: 29, ..Limits::default() };
    assert!(read_limited(&instances, &limits).unwrap_err().contains("vertices: 30"));
    let limits = Limits { max_json_objects: 9, ..Limits::default() };
    assert!(read_limited(&instances, &limits).unwrap_err().contains("JSON objects"));
}

/// Protects the promise that errors point at the place.
#[test]
fn errors_point_at_their_place() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 9] = [
        (|d| d["asset"]["version"] = "1.0".into(), "/asset/version: glTF 1.0 is not supported; convert"),
        (|d| drop(d.as_object_mut().unwrap().remove("asset")), "/asset"),
        (|d| d["bufferViews"][0]["byteLength"] = 37.into(), "/bufferViews/0"),
        (|d| d["bufferViews"][0]["buffer"] = 1.into(), "/bufferViews/0/buffer: buffer 1"),
        (|d| d["buffers"][0]["byteLength"] = 99.into(), "/buffers/0: the buffer has 36 of the 99"),
        (|d| d["buffers"][0]["uri"] = "https://a.b/c.bin".into(), "/buffers/0/uri: https:"),
        (|d| d["buffers"][0]["uri"] = "c.bin".into(), "/buffers/0/uri: cannot be read: \"c.bin\""),
        (|d| d["accessors"][0]["type"] = "VEC2".into(), "/accessors/0/type"),
        (
            |d| d["extensionsRequired"] = json!(["VENDOR_x"]),
            "VENDOR_x is not supported; export the model without",
        ),
    ];
    for (change, expected) in cases {
        let mut document = document(&TRIANGLE);
        change(&mut document);
        let error = read_value(&document).unwrap_err();
        assert!(error.starts_with("x/a.gltf") && error.contains(expected), "{expected}: {error}");
    }
    let mut positions = TRIANGLE;
    positions[4] = f32::NAN;
    let error = read_value(&document(&positions)).unwrap_err();
    assert_eq!(error, "x/a.gltf, at /accessors/0, element 1: the position is not finite");
}

/// Protects the filling of attributes that only some primitives have.
#[test]
fn primitives_with_different_attributes_merge() {
    let mut document = document(&TRIANGLE);
    let normals = add(&mut document, "VEC3", 5126, 3, &floats(&[0.0, 1.0, 0.0].repeat(3)));
    let uvs = add(&mut document, "VEC2", 5126, 3, &floats(&[0.5; 6]));
    document["materials"] =
        json!([{ "name": "red", "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 1] } }]);
    document["meshes"][0]["primitives"] = json!([
        { "attributes": { "POSITION": 0 } },
        { "attributes": { "POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uvs }, "material": 0 },
    ]);
    let model = read_value(&document).unwrap().model;
    assert_eq!(model.mesh.normals[0], Vec3::Z, "flat");
    assert_eq!(model.mesh.normals[3], Vec3::Y);
    assert_eq!((model.mesh.uvs[0], model.mesh.uvs[3]), (Vec2::ZERO, Vec2::splat(0.5)));
    assert_eq!(model.mesh.triangle_materials, [0, 1]);
    assert_eq!((model.materials[0].name.as_str(), model.materials[1].name.as_str()), ("default", "red"));
    assert_eq!(model.materials[1].base_color, [1.0, 0.0, 0.0, 1.0]);
}

/// Protects documents with several scenes, and nodes that are switched off.
#[test]
fn only_the_default_scene_is_shown() {
    let mut document = document(&TRIANGLE);
    document["nodes"] = json!([
        { "mesh": 0 },
        { "mesh": 0, "translation": [5, 0, 0], "children": [2] },
        { "mesh": 0, "extensions": { "KHR_node_visibility": { "visible": false } }, "children": [3] },
        { "mesh": 0 },
    ]);
    document["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
    let positions = |d: &Value| read_value(d).unwrap().model.mesh.positions;
    assert_eq!(positions(&document)[0], Vec3::ZERO, "the first, as no default is given");
    document["scene"] = 1.into();
    assert_eq!(positions(&document).len(), 3, "invisible nodes take their children along");
    assert_eq!(positions(&document)[0], Vec3::X * 5.0);
    assert!(read_value(&document).unwrap().warnings[0].text.contains("invisible"));
}

/// Protects EXT_mesh_gpu_instancing: each instance is placed inside its node.
#[test]
fn instances_are_placed() {
    let mut document = document(&TRIANGLE);
    let half = 0.5f32.sqrt();
    let translation = add(&mut document, "VEC3", 5126, 2, &floats(&[0., 0., 0., 0., 0., 1.]));
    let rotation = add(&mut document, "VEC4", 5126, 2, &floats(&[0., 0., 0., 1., 0., 0., half, half]));
    document["nodes"][0] = json!({ "mesh": 0, "scale": [1, 1, 4], "extensions": { "EXT_mesh_gpu_instancing": {
        "attributes": { "TRANSLATION": translation, "ROTATION": rotation } } } });
    let loaded = read_value(&document).unwrap();
    // A card draws all instances of a node at once.
    assert_eq!(loaded.contents.draw_calls, 1);
    let mesh = loaded.model.mesh;
    assert_eq!((mesh.triangles.len(), mesh.positions[0], mesh.positions[1]), (2, Vec3::ZERO, Vec3::X));
    assert!(mesh.positions[4].distance(Vec3::new(0.0, 1.0, 4.0)) < 1e-6, "{}", mesh.positions[4]);
    document["accessors"][rotation]["count"] = 1.into();
    assert!(read_value(&document).unwrap_err().contains("differ in number"));
}

/// Protects the count of draw calls: each primitive with triangles, at each node.
#[test]
fn draw_calls_are_primitives_at_nodes() {
    let mut document = document(&TRIANGLE);
    let primitive = document["meshes"][0]["primitives"][0].clone();
    let mut points = primitive.clone();
    points["mode"] = 0.into();
    document["meshes"][0]["primitives"] = json!([primitive, points, primitive]);
    document["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [9, 0, 0] }]);
    document["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(read_value(&document).unwrap().contents.draw_calls, 4);
}

/// Protects the time that nodes can cost without adding triangles.
#[test]
fn placings_are_bounded() {
    let mut document = document(&TRIANGLE);
    document["meshes"][0]["primitives"] = json!(vec![json!({ "attributes": {} }); 30]);
    document["nodes"] = json!(vec![json!({ "mesh": 0 }); 30]);
    document["scenes"] = json!([{ "nodes": (0..30).collect::<Vec<_>>() }]);
    let limits = Limits { max_json_objects: 500, ..Limits::default() };
    let error = read_limited(&document, &limits).unwrap_err();
    assert!(error.contains("primitives placed by nodes: 510"), "{error}");
}

/// Protects the words about documents that have no surface, and that they give way
/// to the reason where there is one.
#[test]
fn emptiness_is_explained() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 8] = [
        (|d| d["meshes"] = json!([]), "/nodes/0/mesh: mesh 0"),
        (
            |d| {
                d["meshes"] = json!([]);
                d["nodes"] = json!([{}])
            },
            "the document has no meshes",
        ),
        (|d| d["meshes"][0]["primitives"] = json!([]), "its meshes are empty"),
        (|d| d["meshes"][0]["primitives"][0]["mode"] = 1.into(), "only points and lines"),
        (|d| d["meshes"][0]["primitives"][0]["attributes"] = json!({}), "its meshes have no positions"),
        (|d| d["nodes"] = json!([{}]), "no mesh with triangles is in its scene"),
        (
            |d| {
                d["nodes"] = json!([{}]);
                d["textures"] = json!([{ "source": 3 }])
            },
            "/textures/0/source: image 3",
        ),
        (
            |d| {
                d["nodes"] = json!([{}]);
                d["bufferViews"][0]["buffer"] = 2.into()
            },
            "/bufferViews/0/buffer: buffer 2",
        ),
    ];
    for (change, expected) in cases {
        let mut document = document(&TRIANGLE);
        change(&mut document);
        let error = read_value(&document).unwrap_err();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}
