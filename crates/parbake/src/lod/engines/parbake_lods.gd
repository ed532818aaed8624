@tool
## Shows the levels of a lods.json that Parbake has written, each within its own range of distances.
## Distances follow from the field of view below; change it if your cameras have another one.
extends Node3D

## The file with the levels, beside their GLB files.
@export_file("*.json") var lods := "res://lods.json"
## Vertical field of view of the cameras, in degrees.
@export_range(10.0, 120.0) var field_of_view := 75.0
## Share of a range in which both levels fade into each other.
@export_range(0.0, 0.5) var fade := 0.1


func _ready() -> void:
	var chain: Dictionary = JSON.parse_string(FileAccess.get_file_as_string(lods))
	if chain.is_empty():
		push_error("Parbake: %s is missing or no JSON file" % lods)
		return
	var begin := 0.0
	for level: Dictionary in chain["levels"]:
		var file: String = lods.get_base_dir().path_join(level["file"])
		var scene := load(file) as PackedScene
		if scene == null:
			push_error("Parbake: %s was not imported" % file)
			return
		var end := _distance(chain["longest_side"], level["min_coverage"])
		var instance := scene.instantiate()
		add_child(instance)
		for mesh: GeometryInstance3D in instance.find_children("*", "GeometryInstance3D", true, false):
			mesh.visibility_range_begin = begin
			mesh.visibility_range_begin_margin = fade * begin
			mesh.visibility_range_end = end
			mesh.visibility_range_end_margin = fade * end
			mesh.visibility_range_fade_mode = GeometryInstance3D.VISIBILITY_RANGE_FADE_SELF
			# Levels are made; none is to be made of them.
			mesh.lod_bias = 128.0
		begin = end


## The distance at which a length spans a share of the screen's height; 0 is without end.
func _distance(length: float, share: float) -> float:
	if share <= 0.0:
		return 0.0
	return length / (2.0 * share * tan(deg_to_rad(field_of_view) / 2.0))
