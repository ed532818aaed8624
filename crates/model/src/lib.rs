//! What everything else works on: a [`Model`] is one triangle [`Mesh`] with its
//! [`Material`]s and [`Image`]s, in one frame, whatever the file it came from.
//!
//! Conventions, for every room of the house:
//! * right-handed, +Y up; lengths in the file's unit until [`Placement`] puts a
//!   pair into the common frame;
//! * texture coordinates as in glTF: `(0, 0)` is the outer corner of the first
//!   texel of the first row, `v` grows downwards (OBJ's are flipped on reading);
//! * images are 8-bit RGBA, row 0 on top.

mod basis;
mod cutout;
mod hierarchy;
mod image;
mod material;
mod material_extensions;
mod mesh;
mod node;
mod parallax;
mod parallax_fault;
mod placement;
mod rig;
mod short_uv;
mod texture_slot;

pub use basis::Basis;
pub use cutout::CutoutMap;
pub use glam;
pub use hierarchy::Hierarchy;
pub use image::Image;
pub use material::{AlphaMode, Material};
pub use material_extensions::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, MaterialExtensions, Sheen, Specular,
    Transmission, Volume,
};
pub use mesh::Mesh;
pub use node::{Node, NodeTransform};
pub use parallax::{DepthMap, ParallaxMap};
pub use parallax_fault::ParallaxFault;
pub use placement::{Bounds, Placement};
pub use rig::{
    Animation, Influences, Interpolation, Joint, MOST_INFLUENCES, Morph, MorphTarget, Property, Rig,
    Skeleton, Track,
};
pub use short_uv::{is_short, nearest_short, short_uv, short_uvs_pay};
pub use texture_slot::{TextureSlot, UvTransform, Wrap};

/// A textured model: one mesh, and what its triangles' materials name.
///
/// Contract: every `Mesh::triangle_materials` entry indexes `materials`, and
/// every [`TextureSlot::image`] indexes `images`; every [`ParallaxMap`] passes its
/// check; a [`Rig`] and every [`Hierarchy`] fit the mesh. There is at least one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// A name to show to people, usually the file's.
    pub name: String,
    /// All triangles of the model, node transforms applied.
    pub mesh: Mesh,
    /// Materials, at least one.
    pub materials: Vec<Material>,
    /// Images, each decoded once.
    pub images: Vec<Image>,
    /// Skin, morph targets and animations of this mesh; none of a model in which nothing moves.
    pub rig: Option<Rig>,
    /// The nodes that it was read from; none where a file has none, or where triangles are no longer those of the file.
    pub nodes: Option<Hierarchy>,
    /// F painted importances, 0 to 1, where 0.5 is as if nothing was painted; or empty.
    pub painted: Vec<f32>,
    /// The parts that stay apart, each a node with triangles, and what is above them; what hangs on no node is the
    /// rest. Writers give each a mesh of its own in the node's space; all else that a model was read from is joined.
    pub parts: Option<Hierarchy>,
}

impl Model {
    /// Keeps the triangles for which `kept`, F values, is true, with their materials, painted importances and nodes. All V vertices
    /// stay.
    pub fn retain_triangles(&mut self, kept: &[bool]) {
        fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
            let mut kept = kept.iter();
            values.retain(|_| kept.next().copied().unwrap_or(true));
        }
        retain(&mut self.mesh.triangles, kept);
        retain(&mut self.mesh.triangle_materials, kept);
        retain(&mut self.painted, kept);
        for hierarchy in self.nodes.iter_mut().chain(&mut self.parts) {
            retain(&mut hierarchy.of_triangles, kept);
        }
    }
}
