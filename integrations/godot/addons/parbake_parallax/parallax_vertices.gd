# The attribute _PARALLAX_OFFSET: what the maps' vertices have more than those that viewers without
# the maps show. It is added before Godot's importer parses the file, since that changes the
# vertices' order and does not read the attribute.
@tool
extends RefCounted

const GltfBytes := preload("gltf_bytes.gd")
const OFFSET := "_PARALLAX_OFFSET"


## Moves the vertices of all primitives whose material has a map. The maps' keys are the materials'
## indices.
static func move(state: GLTFState, maps: Dictionary) -> void:
	# Primitives may share accessors, and with others that have no map: new positions go beside the
	# old ones.
	var moved := {}
	for mesh: Dictionary in state.json.get("meshes", []):
		for primitive: Dictionary in mesh.primitives:
			var attributes: Dictionary = primitive.attributes
			if not attributes.has(OFFSET) or not maps.has(int(primitive.get("material", -1))):
				continue
			var pair := Vector2i(int(attributes.POSITION), int(attributes[OFFSET]))
			if not moved.has(pair):
				moved[pair] = _moved(state, pair)
			if moved[pair] >= 0:
				attributes["POSITION"] = moved[pair]
			else:
				push_warning("Vertices of mesh \"%s\" stay without their %s, which cannot be read."
						% [mesh.get("name", ""), OFFSET])


# The accessor of the sums, -1 if there is none.
static func _moved(state: GLTFState, pair: Vector2i) -> int:
	var positions := GltfBytes.vectors(state, pair.x)
	var offsets := GltfBytes.vectors(state, pair.y)
	if positions.is_empty() or positions.size() != offsets.size():
		return -1
	for i in positions.size():
		if offsets[i].is_finite():
			positions[i] += offsets[i]
	return GltfBytes.append(state, positions)
