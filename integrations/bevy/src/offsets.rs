//! The attribute `_PARALLAX_OFFSET`: what the maps' vertices have more than those that viewers without the maps show.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use gltf::accessor::{DataType, Dimensions, Iter};
use gltf::mesh::Mode;

/// The attribute's name.
const OFFSET: &str = "_PARALLAX_OFFSET";

/// Offsets of a primitive's vertices, in the order of those of Bevy's mesh; none if it has no such attribute.
pub(crate) fn read(
    primitive: &gltf::Primitive<'_>,
    buffers: &[Vec<u8>],
    turns_meshes: bool,
) -> Result<Vec<Vec3>, String> {
    let Some((_, accessor)) = primitive.attributes().find(|(name, _)| name.to_string() == OFFSET) else {
        return Ok(Vec::new());
    };
    if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
        return Err(format!("its {OFFSET} is not three floats"));
    }
    let bytes = |buffer: gltf::Buffer<'_>| buffers.get(buffer.index()).map(Vec::as_slice);
    let stored: Iter<'_, [f32; 3]> =
        Iter::new(accessor, bytes).ok_or_else(|| format!("its {OFFSET} cannot be read"))?;
    let turn = if turns_meshes { Vec3::new(-1.0, 1.0, -1.0) } else { Vec3::ONE };
    let finite = |offset: Vec3| if offset.is_finite() { offset } else { Vec3::ZERO };
    let offsets: Vec<Vec3> = stored.map(|offset| finite(turn * Vec3::from(offset))).collect();
    // Triangles without normals get flat ones from Bevy, which gives each corner a vertex for that.
    let is_flat = primitive.get(&gltf::Semantic::Normals).is_none() && primitive.mode() == Mode::Triangles;
    match primitive.reader(bytes).read_indices() {
        Some(indices) if is_flat => {
            let of = |i: u32| offsets.get(i as usize).copied();
            let expanded: Option<_> = indices.into_u32().map(of).collect();
            expanded.ok_or_else(|| "an index is beyond its vertices".into())
        }
        _ => Ok(offsets),
    }
}

/// The mesh that the maps are shown on: the plain one with tangents, and with its vertices moved.
pub(crate) fn moved(plain: &Mesh, offsets: &[Vec3]) -> Result<Mesh, String> {
    let mut mesh = plain.clone();
    if !mesh.contains_attribute(Mesh::ATTRIBUTE_TANGENT) {
        // Bevy makes them only where the material without the maps has a normal texture. Before vertices move, since
        // offsets change nothing but positions.
        mesh.generate_tangents().map_err(|error| format!("it has no tangents, and gets none: {error}"))?;
    }
    if offsets.is_empty() {
        return Ok(mesh);
    }
    let positions = match mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(positions)) if positions.len() == offsets.len() => positions,
        _ => return Err(format!("its {OFFSET} has not as many numbers as its positions")),
    };
    for (position, &offset) in positions.iter_mut().zip(offsets) {
        *position = (Vec3::from(*position) + offset).into();
    }
    if mesh.skinned_mesh_bounds().is_some() {
        mesh.generate_skinned_mesh_bounds().map_err(|error| error.to_string())?;
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::asset::RenderAssetUsages;
    use bevy::mesh::{Indices, PrimitiveTopology};
    use serde_json::json;

    /// A primitive of three vertices with positions, offsets, and indices.
    fn file(offset_type: &str, has_normals: bool) -> (gltf::Gltf, Vec<Vec<u8>>) {
        let numbers: Vec<f32> = vec![
            0.0,
            0.0,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            1.0,
            0.0, // positions
            1.0,
            2.0,
            3.0,
            f32::NAN,
            0.0,
            0.0,
            0.5,
            0.0,
            -0.5, // offsets
        ];
        let mut bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        bytes.extend([2, 1, 0, 0]);
        let mut attributes = json!({ "POSITION": 0, "_PARALLAX_OFFSET": 1 });
        if has_normals {
            attributes["NORMAL"] = json!(0);
        }
        let json = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": bytes.len() }],
            "bufferViews": [
                { "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 36 },
                { "buffer": 0, "byteOffset": 72, "byteLength": 3 },
            ],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
                { "bufferView": 1, "componentType": 5126, "count": 3, "type": offset_type },
                { "bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR" },
            ],
            "meshes": [{ "primitives": [{ "attributes": attributes, "indices": 2 }] }],
        });
        (gltf::Gltf::from_slice(json.to_string().as_bytes()).unwrap(), vec![bytes])
    }

    fn read_first(offset_type: &str, has_normals: bool, turns: bool) -> Result<Vec<Vec3>, String> {
        let (gltf, buffers) = file(offset_type, has_normals);
        let mesh = gltf.meshes().next().unwrap();
        read(&mesh.primitives().next().unwrap(), &buffers, turns)
    }

    /// Protects vertices from standing where the maps do not have them.
    #[test]
    fn offsets_are_those_of_bevy_s_vertices() {
        let [first, last] = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.5, 0.0, -0.5)];
        assert_eq!(read_first("VEC3", true, false), Ok(vec![first, Vec3::ZERO, last]));
        assert_eq!(
            read_first("VEC3", false, false),
            Ok(vec![last, Vec3::ZERO, first]),
            "one for each corner"
        );
        assert_eq!(read_first("VEC3", true, true).unwrap()[0], Vec3::new(-1.0, 2.0, -3.0));
        assert!(read_first("VEC2", true, false).is_err());
    }

    /// Protects what the format leaves as it is.
    #[test]
    fn only_positions_move() {
        let mut plain = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::all());
        plain.insert_attribute(
            Mesh::ATTRIBUTE_POSITION,
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        );
        plain.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 3]);
        plain.insert_attribute(Mesh::ATTRIBUTE_UV_0, vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        plain.insert_indices(Indices::U16(vec![0, 1, 2]));
        let same = moved(&plain, &[]).unwrap();
        assert!(same.contains_attribute(Mesh::ATTRIBUTE_TANGENT));
        let other = moved(&plain, &[Vec3::Z, Vec3::X, Vec3::ZERO]).unwrap();
        for (attribute, values) in other.attributes() {
            let stays = attribute.id != Mesh::ATTRIBUTE_POSITION.id;
            assert_eq!(same.attribute(attribute.id) == Some(values), stays, "{}", attribute.name);
        }
        let positions = other.attribute(Mesh::ATTRIBUTE_POSITION).and_then(VertexAttributeValues::as_float3);
        assert_eq!(positions.unwrap(), [[0.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert!(moved(&plain, &[Vec3::Z]).is_err(), "offsets of another primitive");
    }
}
