//! Tiny scenes. All of them are in the common frame.

use parbake_image::display::{Curve, Display};
use parbake_mesh::HighSurface;
use parbake_model::glam::{Mat3, Vec2, Vec3, vec2, vec3};
use parbake_model::{Material, Mesh, Model};
use parbake_raycast::rays::Rays;
use parbake_raycast::sample::{LIFT, Sample};
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_views::high_poly::{Conventions, HighPoly};
use parbake_views::low_poly::LowPoly;
use parbake_views::pool::Rig;

/// Adds a parallelogram with these edges, which faces along `u` × `v`, with these texture coordinates of its
/// own.
pub fn add_sheet(mesh: &mut Mesh, corner: Vec3, [u, v]: [Vec3; 2], material: u32, [from, to]: [Vec2; 2]) {
    let first = mesh.positions.len() as u32;
    let normal = u.cross(v).normalize();
    for (a, b) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        mesh.positions.push(corner + u * a + v * b);
        mesh.normals.push(normal);
        // v points down in the texture.
        mesh.uvs.push(vec2(from.x + a * (to.x - from.x), to.y - b * (to.y - from.y)));
    }
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    mesh.triangle_materials.extend([material; 2]);
}

/// The whole texture.
pub const WHOLE: [Vec2; 2] = [Vec2::ZERO, Vec2::ONE];

/// A square of this half side across z at this height, facing up.
pub fn square(half: f32, z: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let edges = [Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half];
    add_sheet(&mut mesh, vec3(-half, -half, z), edges, 0, WHOLE);
    mesh
}

/// A box of this half side with hard edges; each side has a ninth of the texture.
pub fn cube(half: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for (index, normal) in
        [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].iter().enumerate()
    {
        let (u, v) = normal.any_orthonormal_pair();
        let corner = (*normal - u - v) * half;
        let from = vec2((index % 3) as f32, (index / 3) as f32) / 3.0 + 0.02;
        add_sheet(&mut mesh, corner, [u, v].map(|e| e * 2.0 * half), 0, [from, from + 0.29]);
    }
    mesh
}

/// A ball of unit normals, fine enough for its facets not to matter.
pub fn ball(radius: f32) -> Mesh {
    let (rings, sides) = (96u32, 192u32);
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        for side in 0..sides {
            let (latitude, longitude) = (
                std::f32::consts::PI * ring as f32 / rings as f32,
                std::f32::consts::TAU * side as f32 / sides as f32,
            );
            let normal =
                vec3(latitude.sin() * longitude.cos(), latitude.sin() * longitude.sin(), latitude.cos());
            mesh.positions.push(radius * normal);
            mesh.normals.push(normal);
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let at = |r: u32, s: u32| r * sides + s % sides;
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

/// A mesh, ready for rays.
pub struct Solid {
    mesh: Mesh,
    surface: HighSurface,
}

impl Solid {
    pub fn new(mesh: &Mesh) -> Self {
        Self { mesh: mesh.clone(), surface: HighSurface::new(mesh) }
    }
}

/// A sample on a surface whose normal there is `normal`, seen from a low-poly at the same place.
pub fn sample_at(solid: &Solid, point: Vec3, normal: Vec3, rays: usize) -> Sample<'_> {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    Sample {
        mesh: &solid.mesh,
        surface: &solid.surface,
        low: point,
        direction: normal,
        frame: Mat3::from_cols(tangent, bitangent, normal),
        point,
        facet: normal,
        smooth: normal,
        mapped: normal,
        origin: point + LIFT * normal,
        rays: Rays::new(rays, 7, 0, 1),
    }
}

/// Both models made ready, for a texture of `size`² texels and rays of this reach.
pub fn pair(high: &Model, low: Mesh, size: usize, max_distance: f32) -> (HighPoly, LowPoly) {
    let conventions = Conventions {
        interpretation: Interpretation::default(),
        display: Display { gain: 1.0, curve: Curve::Srgb },
        whole_material: None,
        rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
        max_distance,
    };
    let high = HighPoly::new(high, conventions).unwrap();
    let low = Model {
        name: "low".into(),
        mesh: low,
        materials: vec![Material::default()],
        images: Vec::new(),
        ..Model::default()
    };
    let low = LowPoly::new(&low, &high.frame, size).unwrap();
    (high, low)
}

/// A model of these materials' colours.
pub fn painted(mesh: Mesh, colors: &[[f32; 3]]) -> Model {
    let material = |&[r, g, b]: &[f32; 3]| Material { base_color: [r, g, b, 1.0], ..Material::default() };
    Model {
        name: "high".into(),
        mesh,
        materials: colors.iter().map(material).collect(),
        images: Vec::new(),
        ..Model::default()
    }
}
