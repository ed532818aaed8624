//! Readers on thousands of damaged files: a model that keeps its contract, or an
//! error; never a panic, a hang or a memory bomb.
//!
//! The damage is the same in every run. `PARBAKE_MUTATIONS` sets the number of
//! cases; with `PARBAKE_DATA`, its small files are damaged too. A failing case is
//! named by its number, from which it can be made again. `fuzz/` looks for what
//! this misses.

mod common;

use common::{check_model, files_below, peak_memory};
use parbake_files::{
    FileError, Limits, Loaded, NoResources, Resources, decode_image, encode_png, glb_bytes, read_gltf_bytes,
    read_obj_bytes,
};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Basis, CutoutMap, Image, Material, Mesh, Model, ParallaxMap, TextureSlot};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

const LIMITS: Limits = Limits {
    max_file_bytes: 1 << 20,
    max_vertices: 100_000,
    max_triangles: 100_000,
    max_image_side: 2048,
    max_image_pixels: 1 << 20,
    max_total_pixels: 1 << 22,
    max_json_objects: 5000,
    confine: true,
};

const MOST_MEMORY: u64 = 300_000_000;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Below `bound`, or 0 where that is 0.
    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    fn choose<'a, T: ?Sized>(&mut self, all: &[&'a T]) -> &'a T {
        all[self.below(all.len())]
    }
}

/// What breaks parsers when it stands in a number's or a word's place.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1",
    "2",
    "255",
    "65535",
    "65536",
    "2147483648",
    "4294967295",
    "4294967296",
    "1e300",
    "-1e39",
    "18446744073709551615",
    "nan",
    "inf",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "[[[[[[",
    "\\",
    "#",
    "0.5",
];

const INTEGERS: [u32; 8] = [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 0x7f80_0000];

/// Damages `bytes` once; `other` is a whole file to take parts from.
fn damage(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let at = random.below(bytes.len());
    let length = 1 + random.below(16);
    let end = (at + length).min(bytes.len());
    match random.below(9) {
        0 => bytes.iter_mut().skip(at).take(1).for_each(|b| *b ^= 1 << random.below(8)),
        1 => bytes.iter_mut().skip(at).take(1).for_each(|b| *b = random.next() as u8),
        2 => drop(bytes.drain(at..end)),
        3 => {
            let part = bytes[at..end].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, part);
        }
        4 => {
            let from = random.below(other.len());
            let part = other[from..(from + 4 * length).min(other.len())].to_vec();
            bytes.splice(at..end, part);
        }
        5 => bytes.truncate(at),
        6 => {
            let value = INTEGERS[random.below(INTEGERS.len())].to_le_bytes();
            bytes.iter_mut().skip(at).zip(value).for_each(|(b, v)| *b = v);
        }
        // Words are hit more often than bytes: numbers in text decide most.
        _ => {
            let is_word = |b: &u8| b.is_ascii_alphanumeric() || b"+-._".contains(b);
            let start = at + bytes[at..].iter().position(is_word).unwrap_or(0);
            let length = bytes[start..].iter().position(|b| !is_word(b)).unwrap_or(0);
            bytes.splice(start..start + length, random.choose(&WORDS).bytes());
        }
    }
}

/// Puts the lengths in a GLB's headers right, so that damage to its JSON is looked at.
fn mend_glb(bytes: &mut [u8]) {
    let binary = bytes.windows(4).rposition(|w| w == b"BIN\0").map_or(bytes.len(), |at| at - 4);
    let mut put = |at: usize, value: usize| {
        if let Some(place) = bytes.get_mut(at..at + 4) {
            place.copy_from_slice(&(value as u32).to_le_bytes());
        }
    };
    put(12, binary.saturating_sub(20));
    let total = bytes.len();
    let mut put = |at: usize, value: usize| {
        if let Some(place) = bytes.get_mut(at..at + 4) {
            place.copy_from_slice(&(value as u32).to_le_bytes());
        }
    };
    put(8, total);
    put(binary, total.saturating_sub(binary + 8));
}

const OBJ: &str = "mtllib a.mtl\no first\nv 0 0 0 1 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1e0 -.5\nv 1 1 0\nv 2 2 .3\n\
    vt 0 0\nvt 1 .5 0\nvt .2 .9\nvn 0 0 1\nvn 0 1 0\nusemtl a\ns 1\ng x y\nf 1/1/1 2/2/1 3/1/1 4/3/2\n\
    f -1//-1 -2//1 -3//-2\nusemtl b c\nf 1 2 \\\n 4\nf 5 4 3 2 1\nl 1 2\np 3\nf 1/1 2/2 3/3\n";

const MTL: &str = "newmtl a\nKd 0.5 0.25 1\nd 0.5\nmap_Kd -s 2 2 -o 0.5 0 -clamp on a.png\nmap_Bump -bm 0.5 a.png\n\
    Ke 0 2 0.5\nmap_Ke a.png\nPr 0.5\nPm 1\nmap_Pr -imfchan g a.png\nmap_Pm -imfchan b a.png\n\
    newmtl b c\nKd 1 1 1\nnorm a.png\n";

const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[
    {"children":[1,2],"scale":[1,-2,1]},{"mesh":0,"translation":[1,0,0],"rotation":[0,0,0,1]},
    {"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3},"indices":4,"material":0,"mode":5},
    {"attributes":{"POSITION":0}}]}],"materials":[{"name":"m","alphaMode":"MASK","normalTexture":{"index":0,"scale":0.5},
    "extensions":{"PARBAKE_materials_parallax_sh":{"order":0,"limit":0.5,"coefficientTextures":[{"index":0}],"scale":[1,0.5],
    "offset":[0,0.1],"depthTexture":{"index":0},"depthScale":2,"depthOffset":-1,"normalTexture":{"index":0,"texCoord":1},
    "cutout":{"order":1,"coefficientTextures":[{"index":0},{"index":0}],"scale":[1,2,0,2],"offset":[0,-1,3.5,-1]}}},
    "pbrMetallicRoughness":{"baseColorFactor":[1,1,0.5,1],"baseColorTexture":{"index":0,"texCoord":0,
    "extensions":{"KHR_texture_transform":{"offset":[0,1],"scale":[2,2],"rotation":0.5}}}}}],
    "textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071,"wrapT":33648}],
    "images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR4nGPUMLJhYGAAAALoAJiVjOJnAAAAAElFTkSuQmCC"}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},
    {"bufferView":1,"componentType":5123,"normalized":true,"count":3,"type":"VEC2"},
    {"componentType":5121,"normalized":true,"count":3,"type":"VEC4","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":1}}},
    {"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":4,"byteLength":12,"byteStride":4},{"buffer":0,"byteOffset":36,"byteLength":4}],
    "buffers":[{"byteLength":40,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA=="}]}"#;

fn glb() -> Vec<u8> {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
        uvs: vec![Vec2::ONE; 3],
        uvs1: vec![Vec2::ZERO; 3],
        colors: vec![Vec4::ONE; 3],
        parallax_offsets: vec![Vec3::Z; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
    };
    let base_color_texture = Some(TextureSlot::default());
    let cutout =
        Some(CutoutMap { basis: Basis::Harmonics(0), images: vec![0], scale: vec![2.0], offset: vec![-1.0] });
    let map = ParallaxMap { images: vec![0], cutout, ..ParallaxMap::default() };
    let parallax =
        Some(ParallaxMap { scale: vec![0.5; 2], offset: vec![-0.1; 2], base_color_texture, ..map });
    let material = Material {
        base_color_texture,
        metallic: 0.5,
        metallic_roughness_texture: base_color_texture,
        occlusion_texture: base_color_texture,
        occlusion_strength: 0.5,
        emissive: [0.5, 1.0, 0.0],
        emissive_texture: base_color_texture,
        emissive_strength: 2.5,
        unlit: true,
        parallax,
        ..Material::default()
    };
    let materials = vec![material];
    glb_bytes(&Model { name: "m".into(), mesh, materials, images: vec![picture()], ..Model::default() })
        .expect("a whole model")
}

fn picture() -> Image {
    let pixels = (0..25).map(|i| [i, 9 * i, 255 - i, 255]).collect();
    Image { name: "p".into(), width: 5, height: 5, pixels }
}

/// A library and a picture, whatever they are asked for.
struct Beside {
    mtl: Vec<u8>,
    png: Vec<u8>,
}

impl Resources for Beside {
    fn read(&self, relative: &str, _max_bytes: u64) -> io::Result<Vec<u8>> {
        Ok(if relative.ends_with(".mtl") { self.mtl.clone() } else { self.png.clone() })
    }
}

/// Names the case when its check fails.
struct Case(u64);

impl Drop for Case {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("this was case {}", self.0);
        }
    }
}

fn check(result: Result<Loaded, FileError>) {
    match result {
        Ok(loaded) => check_model(Path::new("a"), &loaded),
        Err(error) => assert!(error.to_string().starts_with('a'), "{error}"),
    }
}

/// Whole files, damaged in turn.
fn seeds() -> Vec<Vec<u8>> {
    let png = encode_png(&picture()).expect("a whole picture");
    let mut seeds = vec![OBJ.into(), GLTF.into(), glb(), MTL.into(), png];
    // Not asked for through `data_folder`: the test is whole without them.
    let data = std::env::var_os("PARBAKE_DATA").map(PathBuf::from);
    let folders = data.map(|data| ["bad", "extreme", "feature"].map(|f| data.join(f)));
    let files = folders.iter().flatten().flat_map(|folder| files_below(folder));
    seeds.extend(files.filter_map(|path| std::fs::read(path).ok()).filter(|bytes| bytes.len() < 20_000));
    seeds
}

/// Protects the readers from everything that happens to files.
#[test]
fn damaged_files_give_a_model_or_a_clean_error() {
    check(read_gltf_bytes(Path::new("a"), GLTF.as_bytes(), &NoResources, &LIMITS));
    assert!(read_gltf_bytes(Path::new("a"), GLTF.as_bytes(), &NoResources, &LIMITS).is_ok(), "a whole seed");
    let count = std::env::var("PARBAKE_MUTATIONS").map_or(20_000, |n| n.parse().unwrap());
    let (seeds, before) = (seeds(), peak_memory());
    for number in 0..count {
        let case = Case(number);
        let mut random = Random(number);
        let mut bytes = seeds[number as usize % seeds.len()].clone();
        for _ in 0..1 + random.below(6) {
            let other = random.below(seeds.len());
            if bytes.is_empty() {
                break;
            }
            damage(&mut bytes, &seeds[other], &mut random);
        }
        if bytes.starts_with(b"glTF") && random.below(4) > 0 {
            mend_glb(&mut bytes);
        }
        let start = Instant::now();
        let path = Path::new("a");
        let whole = Beside { mtl: MTL.into(), png: encode_png(&picture()).unwrap() };
        check(read_obj_bytes(path, &bytes, &whole, &LIMITS));
        check(read_gltf_bytes(path, &bytes, &NoResources, &LIMITS));
        if let Ok(image) = decode_image("a", &bytes, &LIMITS) {
            assert_eq!(image.pixels.len(), image.width * image.height);
        }
        let damaged = Beside { mtl: bytes.clone(), png: bytes };
        check(read_obj_bytes(path, OBJ.as_bytes(), &damaged, &LIMITS));
        assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
        drop(case);
    }
    let grown = peak_memory().saturating_sub(before);
    assert!(grown < MOST_MEMORY, "{grown} bytes");
}
