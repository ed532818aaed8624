//! All placings of all primitives into one mesh.
//!
//! Attributes that only some primitives have are filled in for the others: flat
//! normals (as glTF 2.0, 3.7.2.1 asks), zero texture coordinates, white colours.
//! Tangents are kept only when all have them. Vertices that no triangle of a
//! primitive uses are left out; the others keep their order.

use super::accessor::Accessor;
use super::animations::Animations;
use super::bind::{Binding, Placing};
use super::buffers::{Buffers, pointer};
use super::json::Primitive;
use super::morphs::{Morphs, Part};
use super::motion::Motion;
use super::painted::Painted;
use super::parallax::{OFFSETS, turns};
use super::scene::{Instance, visit};
use super::sources::{Attributes, Sources, draco_stream};
use super::topology::{has_triangles, triangles};
use super::uv_sets::UvSets;
use crate::{FileError, Place};
use parbake_model::glam::{DAffine3, DMat3, Vec2, Vec3, Vec4};
use parbake_model::{Hierarchy, Mesh, Rig};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

const UNUSED: u32 = u32::MAX;

/// Scales of what has a thickness that are told apart, between one scale and its double.
const SCALES_IN_A_DOUBLING: f64 = 16.0;

/// The mesh so far.
pub(super) struct Merge<'a, 'd> {
    buffers: &'a Buffers<'d>,
    pub mesh: Mesh,
    /// The document's materials (or none, for the default one) in order of first use.
    pub materials: Vec<Option<usize>>,
    /// For each of these, whether a node turns, mirrors or stretches a mesh that has it:
    /// what it says in the mesh's own axes then no longer goes for the merged mesh.
    pub turned: Vec<bool>,
    /// For each, by how much nodes enlarge what has it; what has a thickness is told apart by this.
    pub scales: Vec<f32>,
    material_ids: HashMap<(Option<usize>, i32), u32>,
    has: Attributes,
    /// For each of the document's materials, and by default for the one that says nothing.
    uv_sets: Vec<UvSets>,
    /// Primitives placed so far: even those without triangles take time.
    placed: u64,
    /// Where the last placing was named: instances of one node follow each other, and are one draw call.
    drawn: String,
    /// From a primitive's element numbers to vertices; all `UNUSED` between primitives.
    places: Vec<u32>,
    /// What vertices follow, where something moves.
    pub binding: Option<Binding>,
    pub morphs: Morphs,
    /// For each triangle the document's node that places it.
    pub triangle_nodes: Vec<u32>,
    /// For each triangle what is painted on it, if that is asked for (`painted.rs`).
    pub painted: Painted,
}

impl<'a, 'd> Merge<'a, 'd> {
    pub fn new(buffers: &'a Buffers<'d>) -> Self {
        let all = || buffers.document.meshes.iter().flat_map(|m| &m.primitives).filter(|p| has_triangles(p));
        let uv_sets: Vec<UvSets> = buffers.document.materials.iter().map(UvSets::of).collect();
        let any = |has: fn(&Primitive) -> bool| all().any(has);
        let uvs =
            |place| all().any(|p| p.attributes.texcoord(sets_of(&uv_sets, p).document_set(place)).is_some());
        let has = Attributes {
            normals: any(|p| p.attributes.normal.is_some()),
            tangents: all().all(|p| p.attributes.tangent.is_some() && p.attributes.normal.is_some()),
            uvs: uvs(0),
            uvs1: uvs(1),
            colors: any(|p| p.attributes.color_0.is_some()),
            parallax_offsets: all().any(|p| p.attributes.named(OFFSETS).is_some())
                && buffers.document.materials.iter().any(|m| m.extensions.has_parallax()),
        };
        let (mesh, materials, turned, scales, material_ids, placed, drawn, places) = Default::default();
        let (binding, morphs, triangle_nodes, painted) = Default::default();
        Self {
            buffers,
            mesh,
            materials,
            turned,
            scales,
            material_ids,
            has,
            uv_sets,
            placed,
            drawn,
            places,
            binding,
            morphs,
            triangle_nodes,
            painted,
        }
    }

    /// Adds all placings of all meshes.
    pub fn add_all(&mut self) -> Result<(), FileError> {
        if let Some(motion) = Motion::of(self.buffers)? {
            self.bind(Binding::new(motion))?;
        }
        visit(self.buffers, &mut |instance| self.add(instance))
    }

    /// Looks at all skinned meshes: which joints bend together decides where they stand.
    fn bind(&mut self, mut binding: Binding) -> Result<(), FileError> {
        let (mut seen, mut noted) = (HashSet::new(), HashSet::new());
        for index in binding.motion.order.clone() {
            let node = &self.buffers.document.nodes[index];
            let (Some(mesh), Some(skin)) = (node.mesh, node.skin) else { continue };
            let Some(json) = self.buffers.document.meshes.get(mesh).filter(|_| seen.insert((mesh, skin)))
            else {
                continue;
            };
            for (i, primitive) in json.primitives.iter().enumerate().filter(|(_, p)| has_triangles(p)) {
                let here = format!("/meshes/{mesh}/primitives/{i}");
                let sets = sets_of(&self.uv_sets, primitive);
                let stream = draco_stream(self.buffers, primitive, &here)?;
                // Primitives often share their accessors.
                let own = (primitive.attributes.joints_0, primitive.attributes.weights_0, skin);
                let is_new = stream.is_some() || noted.insert(own);
                if let Some(sources) =
                    Sources::open(self.buffers, primitive, &here, &self.has, sets, stream, is_new)?
                {
                    binding.note(skin, &sources);
                }
            }
        }
        self.binding = Some(binding);
        Ok(())
    }

    /// Adds one placing of a mesh.
    fn add(&mut self, instance: Instance) -> Result<(), FileError> {
        let buffers = self.buffers;
        let meshes = &buffers.document.meshes;
        let Some(mesh) = meshes.get(instance.mesh) else {
            return Err(buffers.missing(&instance.from, "mesh", instance.mesh, meshes.len()));
        };
        self.placed = self.placed.saturating_add(mesh.primitives.len().max(1) as u64);
        let limit = buffers.context.limits.max_json_objects as u64;
        buffers.context.within(
            pointer(instance.from.clone()),
            "primitives placed by nodes",
            self.placed,
            limit,
        )?;
        let is_first = self.drawn != instance.from;
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let here = format!("/meshes/{}/primitives/{i}", instance.mesh);
            if !has_triangles(primitive) {
                buffers.context.warn("points and lines were left out");
                continue;
            }
            let before = self.mesh.triangles.len();
            self.add_primitive(primitive, &here, &instance)?;
            if is_first && self.mesh.triangles.len() > before {
                buffers.context.count_draw_calls(1);
            }
        }
        self.drawn = instance.from;
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &Primitive, here: &str, at: &Instance) -> Result<(), FileError> {
        let context = self.buffers.context;
        let stream = draco_stream(self.buffers, primitive, here)?;
        let sets = sets_of(&self.uv_sets, primitive);
        let skin = at.node.and_then(|node| self.buffers.document.nodes[node].skin);
        let skin = skin.filter(|&skin| self.binding.as_ref().is_some_and(|b| b.motion.skin(skin).is_some()));
        let opened = Sources::open(self.buffers, primitive, here, &self.has, sets, stream, skin.is_some())?;
        let Some(sources) = opened else {
            context.warn(format!("{here} has no positions and was left out"));
            return Ok(());
        };
        let already = self.mesh.triangles.len();
        let triangles = triangles(self.buffers, primitive, here, sources.position.count, already, stream)?;
        if triangles.is_empty() {
            return Ok(());
        }
        let (elements, mut triangles) = if self.has.normals && sources.normal.is_none() {
            separate(&triangles)
        } else {
            compact(triangles, sources.position.count, &mut self.places)
        };
        let first = self.mesh.positions.len();
        let found = (first as u64).saturating_add(elements.len() as u64);
        let limit = (context.limits.max_vertices as u64).min(u64::from(u32::MAX) - 1);
        context.within(pointer(here.into()), "vertices", found, limit)?;
        let placing = self.placing(skin, &sources, &elements, at);
        if context.attribute.is_some() {
            self.painted.add(&sources, &elements, &triangles);
        }
        let determinant = placing.matrices[0].matrix3.determinant();
        let material = self.material(primitive.material, determinant.abs().cbrt(), here)?;
        self.turned[material as usize] |= placing.matrices.iter().any(|matrix| turns(&matrix.matrix3));
        for triangle in &mut triangles {
            *triangle = triangle.map(|i| i + first as u32);
            if determinant < 0.0 {
                triangle.swap(1, 2);
            }
        }
        self.mesh.triangle_materials.resize(already + triangles.len(), material);
        let node = at.node.map_or(Hierarchy::NONE, |node| node as u32);
        self.triangle_nodes.resize(already + triangles.len(), node);
        self.mesh.triangles.append(&mut triangles);
        self.positions(&sources.position, &elements, at, &placing)?;
        self.attributes(&sources, &elements, &placing);
        if self.has.normals && sources.normal.is_none() {
            self.flat_normals(already);
        }
        self.targets(primitive, here, at, &sources, &elements, &placing)
    }

    /// Where a primitive's vertices stand; what they follow is noted.
    fn placing(
        &mut self,
        skin: Option<usize>,
        sources: &Sources<'_>,
        elements: &[u32],
        at: &Instance,
    ) -> Placing {
        match (&mut self.binding, skin.filter(|_| !sources.influences.is_empty())) {
            (Some(binding), Some(skin)) => binding.skinned(skin, sources, elements, &at.world, self.buffers),
            (binding, _) => {
                if let Some(binding) = binding {
                    binding.rigid(at.node, elements.len(), self.buffers);
                }
                Placing::whole(at.world)
            }
        }
    }

    /// The morph targets of a primitive whose vertices are the last ones.
    fn targets(
        &mut self,
        primitive: &Primitive,
        here: &str,
        at: &Instance,
        sources: &Sources<'_>,
        elements: &[u32],
        placing: &Placing,
    ) -> Result<(), FileError> {
        if primitive.targets.is_empty() || self.binding.is_none() {
            return Ok(());
        }
        let ids = self.morphs.ids(self.buffers, at.node, at.mesh);
        let cofactors: Vec<DMat3> = placing.matrices.iter().map(|m| cofactors(&m.matrix3).0).collect();
        let matrix = |i: usize| {
            let k = placing.of(i);
            (placing.matrices[k], cofactors[k])
        };
        let source_normal = |e: u32| {
            sources.normal.as_ref().map_or(Vec3::ZERO, |s| Vec3::from_array(s.read(e as usize, [0.0; 3])))
        };
        let part = Part {
            first: self.mesh.positions.len() - elements.len(),
            elements,
            matrix: &matrix,
            normals: sources.normal.is_some().then_some(&self.mesh.normals),
            source_normal: &source_normal,
        };
        self.morphs.add(self.buffers, primitive, here, &ids, &part, sources.position.count)
    }

    /// The number of a material on what nodes enlarge by `scale`.
    fn material(&mut self, index: Option<usize>, scale: f64, here: &str) -> Result<u32, FileError> {
        let materials = &self.buffers.document.materials;
        let count = materials.len();
        if let Some(index) = index.filter(|&i| i >= count) {
            return Err(self.buffers.missing(&format!("{here}/material"), "material", index, count));
        }
        let next = self.materials.len() as u32;
        // Thickness is given in the mesh's own unit. Scales that are nearly alike are one.
        let volume = index.and_then(|index| materials[index].extensions.volume.as_ref());
        let is_thick = volume.and_then(|v| v.thickness_factor).is_some_and(|t| t > 0.0);
        let class = if is_thick { (scale.log2() * SCALES_IN_A_DOUBLING).round() as i32 } else { 0 };
        let id = *self.material_ids.entry((index, class)).or_insert(next);
        if id == next {
            self.scales.push(scale as f32);
            self.materials.push(index);
            self.turned.push(false);
        }
        Ok(id)
    }

    fn positions(
        &mut self,
        source: &Accessor<'_>,
        elements: &[u32],
        at: &Instance,
        placing: &Placing,
    ) -> Result<(), FileError> {
        let refuse = |element: u32, reason: &str| {
            let place = Place::Element(source.pointer.clone(), element as usize);
            Err(self.buffers.context.invalid(place, reason))
        };
        self.mesh.positions.reserve(elements.len());
        for (i, &element) in elements.iter().enumerate() {
            let position = Vec3::from_array(source.read(element as usize, [0.0; 3]));
            if !position.is_finite() {
                return refuse(element, "the position is not finite");
            }
            let moved = placing.matrices[placing.of(i)].transform_point3(position.as_dvec3()).as_vec3();
            if !moved.is_finite() {
                return refuse(element, &format!("the transform of {} moves it out of range", at.from));
            }
            self.mesh.positions.push(moved);
        }
        Ok(())
    }

    fn attributes(&mut self, sources: &Sources<'_>, elements: &[u32], placing: &Placing) {
        let turns: Vec<(DMat3, DMat3, f32)> = (placing.matrices.iter())
            .map(|DAffine3 { matrix3, .. }| {
                let (cofactors, sign) = cofactors(matrix3);
                (*matrix3, cofactors, sign)
            })
            .collect();
        let turned = |m: &DMat3, still: bool, v: Vec3| {
            // Bits are kept where nothing turns. In doubles: scales of 1e-20 are squared.
            if still { v } else { (*m * v.as_dvec3()).normalize_or_zero().as_vec3() }
        };
        let numbered = || elements.iter().enumerate().map(|(i, &e)| (&turns[placing.of(i)], e as usize));
        let numbers = || elements.iter().enumerate();
        let elements = || elements.iter().map(|&e| e as usize);
        let mesh = &mut self.mesh;
        if let Some(source) = &sources.normal {
            let read = |((matrix, cofactors, _), e): (&(DMat3, DMat3, f32), usize)| {
                turned(cofactors, *matrix == DMat3::IDENTITY, Vec3::from_array(source.read(e, [0.0; 3])))
            };
            mesh.normals.extend(numbered().map(read));
        }
        if let Some(source) = &sources.tangent {
            let read = |((matrix, _, sign), e): (&(DMat3, DMat3, f32), usize)| {
                let tangent = Vec4::from_array(source.read(e, [0.0; 4]));
                turned(matrix, *matrix == DMat3::IDENTITY, tangent.truncate()).extend(tangent.w * sign)
            };
            mesh.tangents.extend(numbered().map(read));
        }
        let uv = |source: &Option<Accessor>, e| {
            source.as_ref().map_or(Vec2::ZERO, |s| Vec2::from_array(s.read(e, [0.0; 2])))
        };
        if self.has.uvs {
            mesh.uvs.extend(elements().map(|e| uv(&sources.uv, e)));
        }
        if self.has.uvs1 {
            mesh.uvs1.extend(elements().map(|e| uv(&sources.uv1, e)));
        }
        if self.has.parallax_offsets {
            let read = |(i, &e): (usize, &u32)| {
                let source = sources.parallax_offset.as_ref();
                let offset = source.map_or(Vec3::ZERO, |s| Vec3::from_array(s.read(e as usize, [0.0; 3])));
                let matrix = &placing.matrices[placing.of(i)].matrix3;
                let offset = (*matrix * offset.as_dvec3()).as_vec3();
                // One that is no number moves nothing.
                if offset.is_finite() { offset } else { Vec3::ZERO }
            };
            mesh.parallax_offsets.extend(numbers().map(read));
        }
        if self.has.colors {
            // Colours go from 0 to 1; NaN passes through, to be repaired and counted.
            let color = |s: &Accessor, e| Vec4::from_array(s.read(e, [1.0; 4]).map(|x| x.clamp(0.0, 1.0)));
            mesh.colors.extend(elements().map(|e| sources.color.as_ref().map_or(Vec4::ONE, |s| color(s, e))));
        }
    }

    /// The rig of what was added; none where nothing moves.
    pub fn rig(&mut self) -> Result<Option<Rig>, FileError> {
        let Some(binding) = &mut self.binding else { return Ok(None) };
        let (mut skeleton, places) = binding.skeleton(self.buffers);
        skeleton.animations = Animations::of(self.buffers, &places, &self.morphs)?;
        let Morphs { targets, morphs, .. } = std::mem::take(&mut self.morphs);
        skeleton.targets = targets;
        if skeleton.joints.is_empty() && skeleton.targets.is_empty() {
            return Ok(None);
        }
        let influences = std::mem::take(&mut binding.influences);
        let rig = Rig { skeleton: Arc::new(skeleton), influences, morphs };
        if let Some(fault) = rig.fault(self.mesh.positions.len()) {
            self.buffers.context.warn(format!("skins and animations were left out: the rig has {fault}"));
            return Ok(None);
        }
        Ok(Some(rig))
    }

    /// For the triangles from `first` on, none of which shares a vertex.
    fn flat_normals(&mut self, first: usize) {
        self.mesh.normals.resize(self.mesh.positions.len(), Vec3::ZERO);
        for triangle in &self.mesh.triangles[first..] {
            let [a, b, c] = triangle.map(|i| self.mesh.positions[i as usize].as_dvec3());
            let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            for &corner in triangle {
                self.mesh.normals[corner as usize] = normal;
            }
        }
    }
}

/// The sets of texture coordinates that a primitive's material asks for.
fn sets_of(uv_sets: &[UvSets], primitive: &Primitive) -> UvSets {
    primitive.material.and_then(|index| uv_sets.get(index)).copied().unwrap_or_default()
}

/// Three vertices of its own for each triangle.
fn separate(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let elements: Vec<u32> = triangles.as_flattened().to_vec();
    let own = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (elements, own)
}

/// The elements in use, in order, and the triangles among them.
fn compact(mut triangles: Vec<[u32; 3]>, count: usize, places: &mut Vec<u32>) -> (Vec<u32>, Vec<[u32; 3]>) {
    if places.len() < count {
        places.resize(count, UNUSED);
    }
    let mut elements = Vec::new();
    for &element in triangles.as_flattened() {
        let place = &mut places[element as usize];
        if *place == UNUSED {
            *place = 0;
            elements.push(element);
        }
    }
    if elements.len() == count {
        elements.clear();
        elements.extend(0..count as u32);
    } else {
        elements.sort_unstable();
    }
    for (place, &element) in elements.iter().enumerate() {
        places[element as usize] = place as u32;
    }
    for corner in triangles.as_flattened_mut() {
        *corner = places[*corner as usize];
    }
    for &element in &elements {
        places[element as usize] = UNUSED;
    }
    (elements, triangles)
}

/// The matrix that turns normals, up to their length: the inverse transpose times
/// |det|, which also exists where the inverse does not. And the determinant's sign.
fn cofactors(m: &DMat3) -> (DMat3, f32) {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    (DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign, sign as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::DVec3;

    /// Protects primitives that share large accessors: only what they use is kept.
    #[test]
    fn compact_keeps_order_and_cleans_up() {
        let mut places = Vec::new();
        let (elements, triangles) = compact(vec![[9, 2, 5], [5, 2, 7]], 10, &mut places);
        assert_eq!(elements, [2, 5, 7, 9]);
        assert_eq!(triangles, [[3, 0, 1], [1, 0, 2]]);
        assert!(places.iter().all(|&p| p == UNUSED));
        let (elements, triangles) = compact(vec![[2, 1, 0]], 3, &mut places);
        assert_eq!((elements, triangles), (vec![0, 1, 2], vec![[2, 1, 0]]));
    }

    /// Protects normals under mirrors: they follow the surface, not the winding.
    #[test]
    fn cofactors_are_the_inverse_transpose() {
        let m = DMat3::from_cols_array(&[-2.0, 0.1, 0.0, 0.3, 1.0, 0.5, 0.0, 0.2, 3.0]);
        let (cofactors, sign) = cofactors(&m);
        assert_eq!(sign, -1.0);
        let expected = m.inverse().transpose() * m.determinant().abs();
        let n = DVec3::new(0.3, -0.5, 0.8);
        assert!((cofactors * n).distance(expected * n) < 1e-12);
    }
}
