//! The accessors of one primitive, from buffers or from its Draco stream.

use super::accessor::Accessor;
use super::buffers::{Buffers, pointer};
use super::draco::Decoded;
use super::json::{self, Primitive};
use super::parallax::OFFSETS;
use super::uv_sets::UvSets;
use crate::FileError;

/// Which attributes the mesh gets.
pub(super) struct Attributes {
    pub normals: bool,
    pub tangents: bool,
    pub uvs: bool,
    pub uvs1: bool,
    pub colors: bool,
    pub parallax_offsets: bool,
}

/// The accessors of one primitive.
pub(super) struct Sources<'a> {
    pub position: Accessor<'a>,
    pub normal: Option<Accessor<'a>>,
    pub tangent: Option<Accessor<'a>>,
    pub uv: Option<Accessor<'a>>,
    pub uv1: Option<Accessor<'a>>,
    pub color: Option<Accessor<'a>>,
    pub parallax_offset: Option<Accessor<'a>>,
    /// What was asked for by its name (`Context::attribute`).
    pub painted: Option<Accessor<'a>>,
    /// Joints and their weights, four at a time.
    pub influences: Vec<[Accessor<'a>; 2]>,
}

/// The Draco stream of a primitive, where that is what it has its positions from: where they also
/// stand uncompressed, for readers without Draco, these lose less and cost nothing.
pub(super) fn draco_stream<'a>(
    buffers: &'a Buffers<'_>,
    primitive: &Primitive,
    here: &str,
) -> Result<Option<&'a Decoded>, FileError> {
    let Some(draco) = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref()) else { return Ok(None) };
    let position = primitive.attributes.position.and_then(|index| buffers.document.accessors.get(index));
    let uncompressed = position.is_some_and(|p| p.buffer_view.is_some() || p.sparse.is_some());
    if uncompressed || primitive.attributes.position.is_none() {
        return Ok(None);
    }
    let here = format!("{here}/extensions/KHR_draco_mesh_compression");
    match (draco.buffer_view, draco.attributes.position) {
        (Some(view), Some(_)) => buffers.stream(view, &here).map(Some),
        _ => Err(buffers.context.invalid(pointer(here), "it has no buffer view or no POSITION")),
    }
}

impl<'a> Sources<'a> {
    /// `None` when the primitive has no positions. What a Draco stream has is taken from there. Joints are opened where
    /// it `is_skinned`.
    pub(super) fn open(
        buffers: &'a Buffers<'_>,
        primitive: &Primitive,
        here: &str,
        has: &Attributes,
        sets: UvSets,
        stream: Option<&'a Decoded>,
        is_skinned: bool,
    ) -> Result<Option<Self>, FileError> {
        let draco = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref());
        type Which<'w> = &'w dyn Fn(&json::Attributes) -> Option<usize>;
        let open = |which: Which<'_>, name: &str, widths: &[usize], wanted: bool| {
            let from = format!("{here}/attributes/{name}");
            let Some(index) = which(&primitive.attributes).filter(|_| wanted) else { return Ok(None) };
            let id = draco.and_then(|draco| which(&draco.attributes));
            let (Some(stream), Some(id)) = (stream, id) else {
                return Accessor::new(buffers, index, &from, widths).map(Some);
            };
            let Some(attribute) = stream.attribute(id) else {
                let place = format!("{here}/extensions/KHR_draco_mesh_compression/attributes/{name}");
                let reason = format!("the Draco stream has no attribute {id}");
                return Err(buffers.context.invalid(pointer(place), reason));
            };
            Accessor::decoded(buffers, index, &from, widths, attribute, stream.points).map(Some)
        };
        let Some(position) = open(&|a| a.position, "POSITION", &[3], true)? else { return Ok(None) };
        let uv = |place: usize| {
            let set = sets.document_set(place);
            open(&|a| a.texcoord(set), &format!("TEXCOORD_{set}"), &[2], true)
        };
        let mut influences = Vec::new();
        let (first, second): ([Which<'_>; 2], [Which<'_>; 2]) =
            ([&|a| a.joints_0, &|a| a.weights_0], [&|a| a.joints_1, &|a| a.weights_1]);
        for (set, [joints, weights]) in [first, second].into_iter().enumerate() {
            let joints = open(joints, &format!("JOINTS_{set}"), &[4], is_skinned)?;
            let weights = open(weights, &format!("WEIGHTS_{set}"), &[4], is_skinned)?;
            influences.extend(joints.zip(weights).map(|(joints, weights)| [joints, weights]));
        }
        let painted = match buffers.context.attribute {
            Some(name) => open(&|a| a.named(name), name, &[1, 2, 3, 4], true)?,
            None => None,
        };
        let sources = Self {
            influences,
            painted,
            normal: open(&|a| a.normal, "NORMAL", &[3], true)?,
            tangent: open(&|a| a.tangent, "TANGENT", &[4], has.tangents)?,
            uv: uv(0)?,
            uv1: uv(1)?,
            color: open(&|a| a.color_0, "COLOR_0", &[3, 4], true)?,
            parallax_offset: open(&|a| a.named(OFFSETS), OFFSETS, &[3], has.parallax_offsets)?,
            position,
        };
        let count = sources.position.count;
        let others = [&sources.normal, &sources.tangent, &sources.uv, &sources.uv1];
        let others =
            others.into_iter().chain([&sources.color, &sources.parallax_offset, &sources.painted]).flatten();
        let different = others.chain(sources.influences.iter().flatten()).find(|a| a.count != count);
        if let Some(other) = different {
            let reason = format!("there are {count} positions, but {} has {}", other.pointer, other.count);
            return Err(buffers.context.invalid(pointer(format!("{here}/attributes")), reason));
        }
        Ok(Some(sources))
    }
}
