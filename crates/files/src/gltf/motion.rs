//! What of a document moves: the nodes of the scene, which of them animations or skins move, and the skins.
//!
//! A node *moves* if an animation has a channel for its transform or a skin in use has it as a joint, and with it all
//! nodes below. What cannot be used is left out with a warning, since the model can do without.

use super::accessor::Accessor;
use super::buffers::Buffers;
use super::scene::walk;
use crate::FileError;
use parbake_model::glam::{DAffine3, DMat4};

/// A node of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat {
    pub parent: Option<usize>,
    /// Nodes above it.
    pub depth: usize,
    pub world: DAffine3,
    /// The node itself or the next one above it that moves by itself.
    pub mover: Option<usize>,
}

/// A skin whose joints are all in the scene.
pub(super) struct Skin {
    pub joints: Vec<usize>,
    /// As many, from the mesh to the joints.
    pub inverse_binds: Vec<DAffine3>,
}

/// The nodes and skins of a document in which something moves.
pub(super) struct Motion {
    /// For each of the document's nodes, if it is in the scene.
    pub seats: Vec<Option<Seat>>,
    /// The nodes of the scene, parents first.
    pub order: Vec<usize>,
    skins: Vec<Option<Skin>>,
}

impl Motion {
    /// None where there are no animations, no skins in use and no morph targets.
    pub fn of(buffers: &Buffers<'_>) -> Result<Option<Self>, FileError> {
        let document = buffers.document;
        let is_skinned =
            |index: usize| document.nodes[index].mesh.is_some().then_some(document.nodes[index].skin);
        let has_skins = (0..document.nodes.len()).any(|index| is_skinned(index).flatten().is_some());
        let has_targets = document.meshes.iter().flat_map(|m| &m.primitives).any(|p| !p.targets.is_empty());
        if !has_skins && !has_targets && document.animations.is_empty() {
            return Ok(None);
        }
        let mut motion =
            Self { seats: vec![None; document.nodes.len()], order: Vec::new(), skins: Vec::new() };
        if document.scenes.is_empty() && document.nodes.is_empty() {
            return Ok(Some(motion));
        }
        walk(buffers, &mut |placed| {
            let above = placed.parent.and_then(|parent| motion.seats[parent]);
            let depth = above.map_or(0, |above| above.depth + 1);
            motion.seats[placed.index] =
                Some(Seat { parent: placed.parent, depth, world: placed.world, mover: None });
            motion.order.push(placed.index);
            Ok(())
        })?;
        motion.skins.resize_with(document.skins.len(), || None);
        let mut moves = vec![false; document.nodes.len()];
        for &index in &motion.order {
            let Some(skin) = is_skinned(index).flatten() else { continue };
            if motion.skins.get(skin).is_some_and(|found| found.is_none()) {
                motion.skins[skin] = motion.read_skin(buffers, skin);
            }
            match motion.skin(skin) {
                Some(skin) => skin.joints.iter().for_each(|&joint| moves[joint] = true),
                None => buffers.context.warn(format!(
                    "skin {skin} was left out: its joints are not all in the scene, or it has none; its meshes do not bend"
                )),
            }
        }
        let channels = document.animations.iter().flat_map(|animation| &animation.channels);
        for target in channels.map(|channel| &channel.target) {
            let is_placed = matches!(target.path.as_str(), "translation" | "rotation" | "scale");
            if let Some(flag) = target.node.filter(|_| is_placed).and_then(|node| moves.get_mut(node)) {
                *flag = true;
            }
        }
        for &index in &motion.order {
            let parent = motion.seats[index].and_then(|seat| seat.parent);
            let inherited = parent.and_then(|parent| motion.seats[parent]).and_then(|above| above.mover);
            if let Some(seat) = &mut motion.seats[index] {
                seat.mover = if moves[index] { Some(index) } else { inherited };
            }
        }
        Ok(Some(motion))
    }

    /// A skin, if it can be used.
    pub fn skin(&self, index: usize) -> Option<&Skin> {
        self.skins.get(index)?.as_ref()
    }

    /// A node, if it is in the scene.
    pub fn seat(&self, node: usize) -> Option<&Seat> {
        self.seats.get(node)?.as_ref()
    }

    fn read_skin(&self, buffers: &Buffers<'_>, index: usize) -> Option<Skin> {
        let json = &buffers.document.skins[index];
        let joints = json.joints.clone();
        let mut seen = std::collections::HashSet::new();
        if joints.is_empty() || !joints.iter().all(|&joint| self.seat(joint).is_some() && seen.insert(joint))
        {
            return None;
        }
        let mut inverse_binds = vec![DAffine3::IDENTITY; joints.len()];
        if let Some(accessor) = json.inverse_bind_matrices {
            let from = format!("/skins/{index}/inverseBindMatrices");
            match Accessor::new(buffers, accessor, &from, &[16]) {
                Ok(accessor) if accessor.count >= joints.len() => {
                    for (i, inverse_bind) in inverse_binds.iter_mut().enumerate() {
                        let columns = accessor.read(i, [0.0f32; 16]).map(f64::from);
                        *inverse_bind = DAffine3::from_mat4(DMat4::from_cols_array(&columns));
                    }
                }
                Ok(_) => return None,
                Err(error) => {
                    buffers.context.warn(error.to_string());
                    return None;
                }
            }
        }
        inverse_binds.iter().all(DAffine3::is_finite).then_some(Skin { joints, inverse_binds })
    }
}
