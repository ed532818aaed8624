//! What a differentiable view is made from: a mesh and what it is covered with, as
//! borrowed slices, so that whoever optimises owns them.
//!
//! Contract: one entry a vertex in each slice that is not empty; finite numbers.

use crate::edges::EdgeAdjacency;
use crate::parallax::ParallaxCoefficients;
use parbake_image::pyramid::Pyramid;
use parbake_model::glam::{Vec2, Vec3, Vec4};

/// The mesh to be rendered.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// V positions in the common frame.
    pub positions: &'a [Vec3],
    /// V normals, or none where the shading does not ask for them.
    pub normals: &'a [Vec3],
    /// V tangents with handedness, or none; only used with a normal texture.
    pub tangents: &'a [Vec4],
    /// V texture coordinates, v down.
    pub uvs: &'a [Vec2],
    /// F triangles.
    pub triangles: &'a [[u32; 3]],
    /// Of these triangles; needed for antialiasing only.
    pub edges: &'a EdgeAdjacency,
}

/// What the surface is covered with. A pyramid of one level is fetched bilinearly.
#[derive(Clone, Copy, Debug)]
pub struct Textures<'a> {
    /// Colours as shading sees them.
    pub color: &'a Pyramid<3>,
    /// Tangent-space normals, not normalised.
    pub normal: Option<&'a Pyramid<3>>,
    /// How coordinates shift before both are fetched.
    pub parallax: Option<&'a ParallaxCoefficients>,
    /// Both have the same sizes and wrap modes: most of the work on fetches is done once.
    pub(crate) shared: bool,
}

impl<'a> Textures<'a> {
    /// A colour texture and perhaps a normal texture, of any sizes.
    pub fn new(color: &'a Pyramid<3>, normal: Option<&'a Pyramid<3>>) -> Self {
        Self { color, normal, parallax: None, shared: normal.is_some_and(|map| map.same_shape(color)) }
    }

    /// The same behind a parallax map.
    pub fn with_parallax(self, parallax: Option<&'a ParallaxCoefficients>) -> Self {
        Self { parallax, ..self }
    }
}
