//! Readers on random bytes and on valid files with random damage: a model that
//! keeps its contract, or an error; never a panic.

use parbake_files::{
    FileError, Limits, Loaded, NoResources, decode_image, encode_png, glb_bytes, read_gltf_bytes,
    read_obj_bytes,
};
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Image, Material, Mesh, Model, TextureSlot};
use proptest::prelude::*;
use std::path::Path;

const LIMITS: Limits = Limits {
    max_file_bytes: 1 << 20,
    max_vertices: 10_000,
    max_triangles: 10_000,
    max_image_side: 256,
    max_image_pixels: 1 << 16,
    max_total_pixels: 1 << 18,
    max_json_objects: 1000,
    confine: true,
};

const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1e0 -.5\nv 1 1 0\nvt 0 0\nvt 1 .5\nvn 0 0 1\n\
    usemtl a\nf 1/1/1 2/2/1 3/1/1 4\nf -1//-1 -2//1 -3\nf 1 2 \\\n 4\n";

fn glb() -> Vec<u8> {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::ONE; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..Mesh::default()
    };
    let base_color_texture = Some(TextureSlot::default());
    let materials = vec![Material { base_color_texture, ..Material::default() }];
    let images = vec![Image::solid("i", 3, 3, [1, 2, 3, 4])];
    glb_bytes(&Model { name: "m".into(), mesh, materials, images, ..Model::default() })
        .expect("a whole model")
}

fn check(result: Result<Loaded, FileError>) {
    match result {
        Ok(loaded) => crate::common::check_model(Path::new("a"), &loaded),
        Err(error) => assert!(error.to_string().starts_with('a'), "{error}"),
    }
}

/// Some bytes overwritten, and the end perhaps cut off.
fn damaged(bytes: Vec<u8>) -> impl Strategy<Value = Vec<u8>> {
    let length = bytes.len();
    let spots = prop::collection::vec((0..length, any::<u8>()), 0..6);
    (spots, prop_oneof![4 => Just(length), 1 => 0..length]).prop_map(move |(spots, end)| {
        let mut bytes = bytes.clone();
        spots.into_iter().for_each(|(at, byte)| bytes[at] = byte);
        bytes.truncate(end);
        bytes
    })
}

proptest! {
    /// Protects against panics on damaged OBJ files.
    #[test]
    fn damaged_obj(bytes in damaged(OBJ.to_vec())) {
        check(read_obj_bytes(Path::new("a"), &bytes, &NoResources, &LIMITS));
    }

    /// Protects against panics on what only resembles OBJ.
    #[test]
    fn words_of_obj(text in "((v|vt|vn|f|usemtl|mtllib|#)( (-?[0-9]{1,3}(/[0-9]?(/-?[0-9])?)?|[0-9.e-]{1,5}|\\\\|nan))*\r?\n){0,20}") {
        check(read_obj_bytes(Path::new("a"), text.as_bytes(), &NoResources, &LIMITS));
    }

    /// Protects against panics on damaged GLB files.
    #[test]
    fn damaged_glb(bytes in damaged(glb())) {
        check(read_gltf_bytes(Path::new("a"), &bytes, &NoResources, &LIMITS));
    }

    /// Protects against panics on noise.
    #[test]
    fn noise(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        check(read_obj_bytes(Path::new("a"), &bytes, &NoResources, &LIMITS));
        check(read_gltf_bytes(Path::new("a"), &bytes, &NoResources, &LIMITS));
        check(read_gltf_bytes(Path::new("a"), &[b"glTF\x02\0\0\0", bytes.as_slice()].concat(), &NoResources, &LIMITS));
    }

    /// Protects the numbers in a GLB document: any of them may be anything.
    #[test]
    fn numbers_of_gltf(choice in any::<prop::sample::Index>(), with in prop_oneof!["-?[0-9]{1,20}", "[0-9]\\.[0-9]e[0-9]{1,3}", "null|true|\\[\\]|\\{\\}|\"x\""]) {
        let bytes = glb();
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let (json, binary) = (&bytes[20..20 + length], &bytes[20 + length..]);
        let numbers: Vec<usize> = (1..json.len()).filter(|&i| json[i].is_ascii_digit() && b":[,".contains(&json[i - 1])).collect();
        let at = *choice.get(&numbers);
        let end = at + json[at..].iter().position(|b| !b.is_ascii_digit() && *b != b'.').unwrap();
        let json = [&json[..at], with.as_bytes(), &json[end..]].concat();
        let total = 20 + json.len() + binary.len();
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((total as u32).to_le_bytes());
        out.extend((json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(&json);
        out.extend(binary);
        check(read_gltf_bytes(Path::new("a"), &out, &NoResources, &LIMITS));
    }

    /// Protects against panics on damaged pictures, and losslessness of whole ones.
    #[test]
    fn pictures(pixels in prop::collection::vec(any::<[u8; 4]>(), 12), spot in 0..200usize, byte in any::<u8>()) {
        let image = Image { name: "a".into(), width: 4, height: 3, pixels };
        let mut bytes = encode_png(&image).unwrap();
        prop_assert_eq!(&decode_image("a", &bytes, &LIMITS).unwrap(), &image);
        let at = spot % bytes.len();
        bytes[at] = byte;
        if let Ok(image) = decode_image("a", &bytes, &LIMITS) {
            prop_assert_eq!(image.pixels.len(), image.width * image.height);
        }
    }
}
