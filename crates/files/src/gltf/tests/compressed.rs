//! Draco and meshopt streams, whole, cut off and lying; sets of texture coordinates beyond two.

use super::*;

/// Two triangles of the unit square with texture coordinates and colours, as Draco's encoder writes
/// them one after the other (number 0: positions, 1: coordinates, 2: colours), ...
const SEQUENTIAL: &str = "445241434f020201000000020401000102020103010300090300000309020001020204010200000100000000000000000000\
    00000000803f0000000000000000000000000000803f000000000000803f0000803f0000000000000000000000000000803f\
    00000000000000000000803f0000803f0000803f0001010009030110012013011003009090698061c6bc0c0000000000ff00\
    0000";

/// ... and by walking over the surface, quantised to 11 and 10 bits.
const EDGEBREAKER: &str = "445241434f02020101000000040202020000011fff0111ff0111ff011103ff00000000000100000100090300000201030902\
    0001020102020401020101010100030301300110030024824a0400000000ff0700000000000000000000000000000000803f\
    0b0101010003030130011003002482a60000000000ff03000000000000000000000000803f0a010101000903011001101301\
    20030050914c62e6dc0c10e0bc0c0000000000ff000000";

fn hex(digits: &str) -> Vec<u8> {
    let digits: Vec<u8> = digits.bytes().filter_map(|b| (b as char).to_digit(16)).map(|d| d as u8).collect();
    digits.as_chunks().0.iter().map(|[high, low]| high * 16 + low).collect()
}

/// A document whose only primitive is this stream.
fn draco(stream: &[u8]) -> Value {
    let accessor = |kind: &str, component: u32, normalized: bool| json!({ "componentType": component, "count": 4, "type": kind, "normalized": normalized });
    json!({
        "asset": { "version": "2.0" },
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 1, "TEXCOORD_0": 2, "COLOR_0": 3 },
            "indices": 0,
            "extensions": { "KHR_draco_mesh_compression": {
                "bufferView": 0, "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2 },
            } },
        }] }],
        "accessors": [
            { "componentType": 5125, "count": 6, "type": "SCALAR" },
            accessor("VEC3", 5126, false), accessor("VEC2", 5126, false), accessor("VEC4", 5121, true),
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": stream.len() }],
        "buffers": [{ "byteLength": stream.len(), "uri": hex_uri(stream) }],
    })
}

const DRACO: &str = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";

/// Protects both ways in which Draco stores a mesh, and what belongs to which vertex.
#[test]
fn draco_streams_are_decoded() {
    for stream in [SEQUENTIAL, EDGEBREAKER] {
        let loaded = read_value(&draco(&hex(stream))).unwrap();
        let mesh = loaded.model.mesh;
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2, 4));
        assert_eq!(loaded.warnings, [""; 0]);
        for i in 0..2 {
            assert!(mesh.area_normal(i).distance(Vec3::Z) < 1e-6, "triangle {i}");
        }
        for (i, position) in mesh.positions.iter().enumerate() {
            assert!(mesh.uvs[i].distance(position.truncate()) < 1e-6, "{position}");
            let color = match position.to_array() {
                [0.0, 0.0, _] => Vec4::new(1.0, 0.0, 0.0, 1.0),
                [1.0, 0.0, _] => Vec4::new(0.0, 1.0, 0.0, 1.0),
                [0.0, 1.0, _] => Vec4::new(0.0, 0.0, 1.0, 1.0),
                _ => Vec4::new(0.2, 0.4, 0.6, 1.0),
            };
            assert!(mesh.colors[i].distance(color) < 1e-6, "{position}: {}", mesh.colors[i]);
        }
    }
}

/// Protects primitives that share a stream, and those that also stand uncompressed.
#[test]
fn draco_is_decoded_once_and_only_where_it_is_needed() {
    let mut document = draco(&hex(SEQUENTIAL));
    document["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [2, 0, 0] }]);
    document["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(read_value(&document).unwrap().model.mesh.positions.len(), 8);
    let limits = Limits { max_vertices: 8, ..Limits::default() };
    assert!(read_limited(&document, &limits).is_ok(), "two uses of one stream are four decoded vertices");
    let mut document = super::document(&TRIANGLE);
    document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] =
        json!({ "bufferView": 0, "attributes": { "POSITION": 0 } });
    assert_eq!(read_value(&document).unwrap().model.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

/// Protects against streams that are cut off anywhere, and damaged everywhere.
#[test]
fn damaged_draco_is_an_error_with_its_place() {
    for stream in [SEQUENTIAL, EDGEBREAKER] {
        let whole = hex(stream);
        for length in 0..whole.len() {
            if let Err(error) = read_value(&draco(&whole[..length])) {
                assert!(
                    error.starts_with("x/a.gltf") && error.contains("/meshes/0")
                        || error.contains("triangles"),
                    "{error}"
                );
            }
        }
        assert!(read_value(&draco(&whole[..whole.len() / 2])).unwrap_err().contains(DRACO));
        for at in 0..whole.len() {
            for flip in [1, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] ^= flip;
                if let Err(error) = read_value(&draco(&bytes)) {
                    assert!(error.starts_with("x/a.gltf"), "{error}");
                }
            }
        }
    }
}

/// Protects memory: a stream's own counts are held against the limits.
#[test]
fn draco_keeps_to_the_limits() {
    let document = draco(&hex(SEQUENTIAL));
    for limits in
        [Limits { max_vertices: 3, ..Limits::default() }, Limits { max_triangles: 1, ..Limits::default() }]
    {
        let error = read_limited(&document, &limits).unwrap_err();
        assert!(error.contains(DRACO) && error.contains("limit"), "{error}");
    }
}

/// Protects the words about attributes that the stream does not have.
#[test]
fn draco_attributes_must_be_there() {
    let mut document = draco(&hex(SEQUENTIAL));
    let extension = "KHR_draco_mesh_compression";
    document["meshes"][0]["primitives"][0]["extensions"][extension]["attributes"]["TEXCOORD_0"] = json!(7);
    let error = read_value(&document).unwrap_err();
    assert!(
        error.contains(&format!("{DRACO}/attributes/TEXCOORD_0: the Draco stream has no attribute 7")),
        "{error}"
    );
    document["meshes"][0]["primitives"][0]["extensions"][extension]["attributes"]["TEXCOORD_0"] = json!(0);
    let error = read_value(&document).unwrap_err();
    assert!(error.contains("/accessors/2/type") && error.contains("3 components"), "{error}");
}

/// Adds a compressed buffer view in place of view `view`; the bytes that it stands for have nothing
/// but a length.
fn compress(document: &mut Value, view: usize, name: &str, stream: &[u8], extension: Value) {
    let buffers = document["buffers"].as_array_mut().unwrap();
    buffers.push(json!({ "byteLength": stream.len(), "uri": hex_uri(stream) }));
    let mut extension = extension;
    extension["buffer"] = (buffers.len() - 1).into();
    extension["byteLength"] = stream.len().into();
    let view = &mut document["bufferViews"][view];
    let old = view["buffer"].as_u64().unwrap() as usize;
    view["extensions"][name] = extension;
    let length = document["buffers"][old]["byteLength"].clone();
    document["buffers"][old] = json!({ "byteLength": length, "extensions": { name: { "fallback": true } } });
}

/// The unit square in 16-bit quantised positions, and its indices.
fn square() -> (Value, Vec<u8>, Vec<u8>) {
    let positions: [[u16; 4]; 4] = [[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]];
    let mut document = document(&TRIANGLE);
    let bytes: Vec<u8> = positions.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    let accessor = add(&mut document, "VEC3", 5123, 4, &bytes);
    document["bufferViews"][1]["byteStride"] = json!(8);
    let indices = [0u32, 1, 2, 2, 1, 3];
    let bytes: Vec<u8> = indices.iter().flat_map(|&v| (v as u16).to_le_bytes()).collect();
    let index = add(&mut document, "SCALAR", 5123, 6, &bytes);
    document["meshes"][0]["primitives"][0] =
        json!({ "attributes": { "POSITION": accessor }, "indices": index });
    let vertices = ::meshopt::encode_vertex_buffer(&positions).unwrap();
    (document, vertices, ::meshopt::encode_index_buffer(&indices, 4).unwrap())
}

fn vertex_extension() -> Value {
    json!({ "byteStride": 8, "count": 4, "mode": "ATTRIBUTES" })
}

fn index_extension() -> Value {
    json!({ "byteStride": 2, "count": 6, "mode": "TRIANGLES", "filter": "NONE" })
}

/// Protects meshopt's streams under both of the extension's names, without any fallback.
#[test]
fn meshopt_views_are_decoded() {
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let (mut document, vertices, indices) = square();
        let plain = read_value(&document).unwrap().model.mesh;
        compress(&mut document, 1, name, &vertices, vertex_extension());
        compress(&mut document, 2, name, &indices, index_extension());
        document["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
        let mesh = read_value(&document).unwrap().model.mesh;
        assert_eq!(mesh.positions, plain.positions);
        // The stream turns triangles, it does not change them.
        assert!((0..2).all(|i| mesh.area_normal(i).distance(Vec3::Z) < 1e-6));
    }
}

/// Protects normals under the octahedral filter, and lists of indices that are no triangles.
#[test]
fn meshopt_filters_and_sequences() {
    let (mut document, vertices, _) = square();
    let name = "EXT_meshopt_compression";
    let normal = [0.6f32, 0.0, 0.8, 0.0];
    let encoded: Vec<[i8; 4]> = ::meshopt::encode_filter_oct(&[normal; 4], 8);
    let stream = ::meshopt::encode_vertex_buffer(&encoded).unwrap();
    let normals = add(&mut document, "VEC3", 5120, 4, &[0; 16]);
    document["accessors"][normals]["normalized"] = json!(true);
    document["bufferViews"][3]["byteStride"] = json!(4);
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    document["meshes"][0]["primitives"][0]["mode"] = json!(5);
    let strip = ::meshopt::encode_index_sequence(&[0, 1, 2, 3], 4).unwrap();
    document["accessors"][2]["count"] = json!(4);
    compress(&mut document, 1, name, &vertices, vertex_extension());
    compress(&mut document, 2, name, &strip, json!({ "byteStride": 2, "count": 4, "mode": "INDICES" }));
    let filter = json!({ "byteStride": 4, "count": 4, "mode": "ATTRIBUTES", "filter": "OCTAHEDRAL" });
    compress(&mut document, 3, name, &stream, filter);
    let mesh = read_value(&document).unwrap().model.mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert!(mesh.normals.iter().all(|n| n.distance(Vec3::new(0.6, 0.0, 0.8)) < 0.02), "{:?}", mesh.normals);
}

/// Protects memory and the reader from streams that are cut off, damaged or promise too much.
#[test]
fn damaged_meshopt_is_an_error_with_its_place() {
    let name = "EXT_meshopt_compression";
    let here = "/bufferViews/1/extensions/EXT_meshopt_compression";
    let (document, vertices, _) = square();
    let read = |stream: &[u8], extension: Value| {
        let mut document = document.clone();
        compress(&mut document, 1, name, stream, extension);
        read_value(&document)
    };
    for length in 0..vertices.len() {
        let error = read(&vertices[..length], vertex_extension()).unwrap_err();
        assert!(error.contains(here), "{length}: {error}");
    }
    for at in 0..vertices.len() {
        let mut bytes = vertices.clone();
        bytes[at] ^= 0xff;
        if let Err(error) = read(&bytes, vertex_extension()) {
            assert!(error.starts_with("x/a.gltf"), "{error}");
        }
    }
    for (part, value, reason) in [
        ("count", json!(1u64 << 40), "cannot come from"),
        ("count", json!(3), "cannot be decoded"),
        ("byteStride", json!(7), "elements of 7 bytes"),
        ("byteStride", json!(512), "elements of 512 bytes"),
        ("mode", json!("LINES"), "\"LINES\" is no mode"),
        ("filter", json!("QUATERNIONS"), "cannot be applied"),
        ("byteOffset", json!(9000), "reach beyond"),
    ] {
        let mut extension = vertex_extension();
        extension[part] = value;
        let error = read(&vertices, extension).unwrap_err();
        assert!(error.contains(reason) && error.contains(here), "{part}: {error}");
    }
    let mut document = document.clone();
    compress(&mut document, 1, name, &vertices, vertex_extension());
    let limits = Limits { max_file_bytes: 31, ..Limits::default() };
    let error = read_limited(&document, &limits).unwrap_err();
    assert!(error.contains("bytes of all buffers: 32"), "{error}");
}

/// Protects materials whose textures ask for a third set: it takes the place of one that is not asked for.
#[test]
fn further_uv_sets_take_a_free_place() {
    let mut document = document(&TRIANGLE);
    let set = |document: &mut Value, value: f32| add(document, "VEC2", 5126, 3, &floats(&[value; 6]));
    let (first, second, third) = (set(&mut document, 0.0), set(&mut document, 1.0), set(&mut document, 2.0));
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = first.into();
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = second.into();
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_2"] = third.into();
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let png = crate::encode_png(&parbake_model::Image::solid("a", 1, 1, [1, 2, 3, 255])).unwrap();
    document["images"] = json!([{ "uri": hex_uri(&png).replace("application/octet-stream", "image/png") }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "normalTexture": { "index": 0, "texCoord": 2 },
    }]);
    let loaded = read_value(&document).unwrap();
    let material = &loaded.model.materials[0];
    assert_eq!(material.base_color_texture.unwrap().uv_set, 0);
    assert_eq!(material.normal_texture.unwrap().uv_set, 1);
    assert_eq!((loaded.model.mesh.uvs[0], loaded.model.mesh.uvs1[0]), (Vec2::ZERO, Vec2::splat(2.0)));
    document["materials"][0]["occlusionTexture"] = json!({ "index": 0, "texCoord": 1 });
    let loaded = read_value(&document).unwrap();
    assert!(loaded.model.materials[0].occlusion_texture.is_none());
    assert!(loaded.warnings[0].text.contains("/materials/0/occlusionTexture"), "{:?}", loaded.warnings);
}
