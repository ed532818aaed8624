//! The functions of all shaders against the CPU renderer, and against the numbers of the format page.

use crate::interpreter::{Interpreter, Textures};
use crate::operators::Value;
use crate::shaders;
use naga::Module;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Basis, CutoutMap, Image, ParallaxMap};
use parbake_render::cutout::CutoutCoefficients;
use parbake_render::directions::{VertexFrame, ViewDirection, view_direction};
use parbake_render::parallax::ParallaxCoefficients;

/// Whose shader it is, since names and parameters differ.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Engine {
    Bevy,
    Godot,
    UnityAndUnreal,
}

struct Shader {
    engine: Engine,
    module: Module,
}

fn all() -> Vec<Shader> {
    let mut shaders = vec![
        Shader { engine: Engine::Bevy, module: shaders::wgsl() },
        Shader { engine: Engine::Godot, module: shaders::godot() },
    ];
    shaders.extend(shaders::hlsl().map(|module| Shader { engine: Engine::UnityAndUnreal, module }));
    shaders
}

/// A map with its images: the shift's, the cutout's.
struct Maps {
    map: ParallaxMap,
    images: [Image; 2],
}

const LAYERS: [usize; 2] = [2, 3];

fn v2(v: Vec2) -> Value {
    Value::vector(&[v.x, v.y])
}

fn v3(v: Vec3) -> Value {
    Value::vector(&[v.x, v.y, v.z])
}

fn v4(v: Vec4) -> Value {
    Value::vector(&[v.x, v.y, v.z, v.w])
}

/// Linear filter, clamped, as a sampler has it.
fn fetch(image: &Image, layers: usize, [u, v]: [f32; 2], layer: Option<usize>) -> [f32; 4] {
    let rows = image.height / layers;
    // Without a layer the image is a strip.
    let (first, rows) = layer.map_or((0, image.height), |layer| (layer * rows, rows));
    let (x, y) = (u * image.width as f32 - 0.5, v * rows as f32 - 0.5);
    let mut sum = [0.0; 4];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let weight = |at: f32, step: i32| if step == 0 { 1.0 - (at - at.floor()) } else { at - at.floor() };
        let clamp = |at: f32, step: i32, n: usize| (at.floor() as i32 + step).clamp(0, n as i32 - 1) as usize;
        let texel = image.pixels[(first + clamp(y, dy, rows)) * image.width + clamp(x, dx, image.width)];
        let w = weight(x, dx) * weight(y, dy);
        sum.iter_mut().zip(texel).for_each(|(sum, byte)| *sum += w * f32::from(byte) / 255.0);
    }
    sum
}

impl Maps {
    fn vectors(numbers: &[f32]) -> Vec<Vec4> {
        numbers.chunks_exact(4).map(Vec4::from_slice).collect()
    }

    /// Scales and offsets of the layers of the shift, or of the cutout.
    fn ranges(&self, which: usize) -> [Vec<Vec4>; 2] {
        let cutout = self.map.cutout.as_ref().unwrap();
        let [scale, offset] =
            if which == 0 { [&self.map.scale, &self.map.offset] } else { [&cutout.scale, &cutout.offset] };
        [Self::vectors(scale), Self::vectors(offset)]
    }
}

impl Shader {
    /// Calls a function of Bevy's or Godot's shader.
    fn call(&self, maps: Option<&Maps>, name: &str, arguments: Vec<Value>) -> Vec<f32> {
        self.run(maps, |interpreter| interpreter.call(name, arguments)).numbers()
    }

    /// Runs what calls all functions of HLSL, and takes one of its outputs.
    fn enter(&self, maps: Option<&Maps>, output: usize, inputs: &[(&str, Value)]) -> Vec<f32> {
        self.run(maps, |interpreter| interpreter.enter(inputs)).part(output).numbers()
    }

    fn run(&self, maps: Option<&Maps>, run: impl FnOnce(&mut Interpreter) -> Value) -> Value {
        let sizes = maps.map_or([[1; 2]; 2], |m| [0, 1].map(|i| [m.images[i].width, m.images[i].height]));
        let fetch = |texture: usize, at: [f32; 2], layer: Option<usize>| {
            maps.map_or([0.0; 4], |maps| fetch(&maps.images[texture], LAYERS[texture], at, layer))
        };
        let textures = Textures { names: &["shiftMap", "cutoutMap"], sizes: &sizes, fetch: &fetch };
        run(&mut Interpreter::new(&self.module, &textures))
    }

    fn line(&self, to_viewer: Vec3, frame: &VertexFrame) -> Vec3 {
        let (d, normal, tangent) = (v3(to_viewer), v3(frame.normal), v3(frame.tangent));
        let side = frame.handedness;
        Vec3::from_slice(&match self.engine {
            Engine::Bevy => self.call(None, "line_of_sight", vec![d, normal, v4(frame.tangent.extend(side))]),
            Engine::Godot => self.call(None, "parallax_line", vec![d, normal, tangent, Value::F(side)]),
            Engine::UnityAndUnreal => {
                let rest = Value::vector(&[side, 0.0, 0.0, 0.0]);
                let inputs = [("toViewer", d), ("normal", normal), ("tangent", tangent), ("rest", rest)];
                let first = self.enter(None, 0, &inputs);
                assert_eq!(first[3], 0.0, "the line differs if the bitangent is given");
                first[..3].to_vec()
            }
        })
    }

    /// Coefficients at t of a map's layers, where Godot's shader looks for them in the image.
    fn layers(&self, maps: &Maps, which: usize, t: Vec2) -> Vec<Value> {
        let (image, [scale, offset]) = (&maps.images[which], maps.ranges(which));
        let (count, rows) = (LAYERS[which], image.height / LAYERS[which]);
        let layer = |i: usize| {
            let arguments = [i, count, rows].map(|n| Value::F(n as f32));
            let at = self.call(None, "parallax_strip", [vec![v2(t)], arguments.to_vec()].concat());
            v4(offset[i] + scale[i] * Vec4::from(fetch(image, count, [at[0], at[1]], None)))
        };
        (0..count).map(layer).collect()
    }

    /// What Bevy's functions that fetch want: texture, sampler, t, the line of sight, and all numbers.
    fn sampled(maps: &Maps, which: usize, t: Vec2, line: Vec3) -> Vec<Value> {
        let numbers = [0, 1].into_iter().flat_map(|i| maps.ranges(i));
        let mut numbers: Vec<Value> =
            numbers.map(|list| Value::Of(list.into_iter().map(v4).collect())).collect();
        numbers.extend([maps.map.limit, f32::MAX].map(Value::F));
        vec![Value::Texture(which), Value::Sampler, v2(t), v3(line), Value::Of(numbers)]
    }

    /// The second output of HLSL's `main`, with the numbers of a map as its inputs.
    fn second(&self, maps: &Maps, which: usize, t: Vec2, line: Vec3) -> Vec<f32> {
        let rest = Value::vector(&[1.0, maps.map.limit, 0.0, 1.0]);
        let mut inputs = vec![("t", v2(t)), ("view_direction", v3(line)), ("rest", rest)];
        let ranges = maps.ranges(which).concat().into_iter().map(v4);
        inputs.extend(["a", "b", "c", "d", "e", "f"].into_iter().zip(ranges));
        self.enter(Some(maps), 1, &inputs)
    }

    fn shift(&self, maps: &Maps, t: Vec2, line: Vec3) -> Vec2 {
        let have = match self.engine {
            Engine::Bevy => self.call(Some(maps), "shift_at", Self::sampled(maps, 0, t, line)),
            Engine::Godot => {
                let rest = vec![v3(line), Value::F(maps.map.limit)];
                self.call(None, "parallax_shift", [self.layers(maps, 0, t), rest].concat())
            }
            Engine::UnityAndUnreal => self.second(maps, 0, t, line),
        };
        Vec2::new(have[0], have[1])
    }

    fn opacity(&self, maps: &Maps, t: Vec2, line: Vec3) -> f32 {
        match self.engine {
            Engine::Bevy => self.call(Some(maps), "opacity_at", Self::sampled(maps, 1, t, line))[0],
            Engine::Godot => {
                self.call(None, "parallax_opacity", [self.layers(maps, 1, t), vec![v3(line)]].concat())[0]
            }
            Engine::UnityAndUnreal => self.second(maps, 1, t, line)[2],
        }
    }

    fn fade(&self, along: Vec2, down: Vec2, z: f32, footprint: f32) -> f32 {
        let arguments = vec![v2(along), v2(down), Value::F(z), Value::F(footprint)];
        match self.engine {
            Engine::Bevy => self.call(None, "fade_of", arguments)[0],
            Engine::Godot => self.call(None, "parallax_fade", arguments)[0],
            Engine::UnityAndUnreal => {
                let rest = Value::vector(&[1.0, 1.0, z, footprint]);
                self.enter(None, 2, &[("along", v2(along)), ("down", v2(down)), ("rest", rest)])[0]
            }
        }
    }

    fn faded(&self, opacity: f32, fade: f32) -> f32 {
        let arguments = vec![Value::F(opacity), Value::F(fade)];
        match self.engine {
            Engine::Bevy => self.call(None, "faded_opacity", arguments)[0],
            Engine::Godot => self.call(None, "parallax_faded", arguments)[0],
            Engine::UnityAndUnreal => {
                self.enter(None, 2, &[("rest", Value::vector(&[1.0, opacity, fade, 1.0]))])[1]
            }
        }
    }

    /// None for Godot's, whose material has no alpha to coverage.
    fn coverage(&self, opacity: f32, width: f32) -> Option<f32> {
        match self.engine {
            Engine::Bevy => Some(self.call(None, "coverage_of", vec![Value::F(opacity), Value::F(width)])[0]),
            Engine::Godot => None,
            Engine::UnityAndUnreal => {
                let rest = Value::vector(&[1.0, opacity, width, 1.0]);
                Some(self.enter(None, 2, &[("rest", rest)])[2])
            }
        }
    }
}

/// The JSON of the format page, with these pixels.
fn maps_of(width: usize, rows: [usize; 2], pixels: [Vec<[u8; 4]>; 2]) -> Maps {
    let mut pixels = pixels.into_iter();
    let mut image =
        |height: usize| Image { width, height, pixels: pixels.next().unwrap(), ..Image::default() };
    let images = [image(LAYERS[0] * rows[0]), image(LAYERS[1] * rows[1])];
    let map = ParallaxMap {
        basis: Basis::TangentShift,
        images: vec![0],
        scale: vec![0.2, 0.1, 0.1, 0.4, 0.5, 0.2, 0.1, 0.3],
        offset: vec![-0.1, 0.0, -0.05, -0.2, -0.25, -0.1, 0.0, -0.15],
        cutout: Some(CutoutMap {
            basis: Basis::TangentCutout,
            images: vec![1],
            scale: vec![5.0, 2.0, 4.0, 3.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0, 0.5, 0.5],
            offset: vec![-1.0, -1.0, -2.0, -1.5, -0.5, -0.5, -1.0, -1.0, -0.5, -0.5, -0.25, -0.25],
        }),
        ..ParallaxMap::default()
    };
    assert_eq!(map.check(&images), Ok(()));
    Maps { map, images }
}

fn worked_example() -> Maps {
    let shift = vec![[0, 255, 51, 204], [255, 102, 51, 0], [153, 0, 255, 51], [0, 51, 204, 255]];
    let cutout = vec![
        [102, 204, 153, 51],
        [204, 0, 255, 102],
        [51, 255, 0, 153],
        [153, 51, 102, 0],
        [0, 102, 204, 255],
        [255, 153, 51, 0],
    ];
    maps_of(2, [1, 1], [shift, cutout])
}

/// Numbers of 0 … 1 that are the same each time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn pixels(&mut self, count: usize) -> Vec<[u8; 4]> {
        (0..count).map(|_| std::array::from_fn(|_| (self.next() * 255.0) as u8)).collect()
    }
}

/// Protects readers in other engines: the numbers of the format page.
#[test]
fn shaders_have_the_numbers_of_the_worked_example() {
    let (maps, t) = (worked_example(), Vec2::new(0.4, 0.5));
    let cases = [
        (Vec3::new(0.48, -0.6, 0.64), Vec2::new(-0.077_475, 0.007_560), 0.677_141),
        (Vec3::new(0.6, 0.8, 0.0), Vec2::new(-0.192, 0.2736), 6.985_007),
    ];
    for shader in all() {
        for (line, shift, opacity) in cases {
            let have = (shader.shift(&maps, t, line), shader.opacity(&maps, t, line));
            assert!(have.0.distance(shift) < 2e-6, "{:?}: a shift of {}", shader.engine, have.0);
            assert!((have.1 - opacity).abs() < 1e-5, "{:?}: an opacity of {}", shader.engine, have.1);
        }
        // One and a half times the footprint at which the fade begins.
        let (z, footprint) = (0.64, 0.0625);
        let fade = shader.fade(Vec2::new(0.0, 0.093_75 / z), Vec2::new(0.01, 0.0), z, footprint);
        assert!((fade - 0.5).abs() < 1e-6, "{:?}: a fade of {fade}", shader.engine);
        let left = shader.faded(0.677_141, fade);
        assert!((left - 0.838_570).abs() < 1e-6, "{:?}: an opacity of {left} with fade", shader.engine);
        let [none, all] =
            [0.2, 0.05].map(|along| shader.fade(Vec2::new(along, 0.0), Vec2::ZERO, 1.0, footprint));
        assert_eq!((none, all), (0.0, 1.0), "{:?}", shader.engine);
        for (opacity, width, want) in
            [(0.05, 0.2, 0.75), (-0.2, 0.2, 0.0), (0.3, 5.0, 0.56), (3.0, 40.0, 0.8), (0.0, 0.0, 0.5)]
        {
            if let Some(have) = shader.coverage(opacity, width) {
                assert!((have - want).abs() < 1e-6, "{:?}: a coverage of {have}", shader.engine);
            }
        }
    }
}

/// Protects lines of sight: both sides of a surface, mirrored texture, tangents that are not perpendicular.
#[test]
fn lines_of_sight_are_those_of_the_cpu() {
    let mut random = Random(7);
    for shader in all() {
        for handedness in [1.0, -1.0].repeat(40) {
            let frame = VertexFrame { normal: random.vector(), tangent: random.vector(), handedness };
            let to_viewer = random.vector().normalize();
            let want = view_direction(Basis::TangentShift, &frame, to_viewer).direction;
            let have = shader.line(to_viewer, &frame);
            assert!(have.distance(want) < 2e-5, "{:?} {frame:?}: {have} instead of {want}", shader.engine);
        }
    }
}

/// Protects faces that are seen almost edge on: which side is seen is told by the sign alone.
#[test]
fn lines_of_sight_turn_at_the_horizon() {
    let frame = VertexFrame { normal: Vec3::Z, tangent: Vec3::X, handedness: 1.0 };
    for shader in all() {
        for z in [0.002, -0.002] {
            let to_viewer = Vec3::new(0.8, 0.6, z).normalize();
            assert!(
                shader.line(to_viewer, &frame).distance(to_viewer * z.signum()) < 1e-6,
                "{:?}",
                shader.engine
            );
        }
    }
}

/// Protects Unity, whose first row of an image is at v = 1.
#[test]
fn flipped_coordinates_count_from_below() {
    for shader in all().iter().filter(|shader| shader.engine == Engine::UnityAndUnreal) {
        assert_eq!(shader.enter(None, 2, &[("t", v2(Vec2::new(0.25, 0.125)))])[3], 0.875);
    }
}

/// Protects all coefficients and layers, and the borders between layers: shifts and opacities of arbitrary maps.
#[test]
fn shifts_and_opacities_are_those_of_the_cpu() {
    let mut random = Random(11);
    let (width, rows) = (5, [4, 7]);
    let maps = maps_of(width, rows, [0, 1].map(|i| random.pixels(width * rows[i] * LAYERS[i])));
    let shifts = ParallaxCoefficients::unpack(&maps.map, &maps.images).unwrap();
    let cutout = maps.map.cutout.as_ref().unwrap();
    let cutout = CutoutCoefficients::unpack(cutout, maps.map.wrap, &maps.images).unwrap();
    for shader in all() {
        for _ in 0..80 {
            let mut line = random.vector().normalize();
            line.z = line.z.abs();
            // Past the borders, too: all is clamped.
            let t = Vec2::new(random.next(), random.next()) * 1.4 - 0.2;
            let want = shifts.shift(t, &ViewDirection { direction: line, cosine: line.z });
            let have = shader.shift(&maps, t, line);
            assert!(have.distance(want) < 1e-5, "{:?} {t} {line}: {have} instead of {want}", shader.engine);
            let (want, have) = (cutout.opacity(t, line), shader.opacity(&maps, t, line));
            assert!((have - want).abs() < 3e-5, "{:?} {t} {line}: {have} instead of {want}", shader.engine);
        }
    }
}
