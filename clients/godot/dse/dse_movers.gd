# Road users as nodes of a scene. Its children are templates: "car", "truck", "motorcycle", "bicycle", "pedestrian" and
# "obstacle" with their origin on the road, and "box", a cube of 1 m around its origin, for classes without a template.
extends Node

const DseFrame = preload("res://dse/dse_frame.gd")
const CLASSES = ["none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle"] # actor_class

var _shown = {}
var _classes = {}


func _enter_tree():
	for template in get_children():
		template.visible = false


# Shows what is at a place, or nothing if kind is 0. Size: width, height, length in m; x, y, z in m of the road below
# its middle, heading in rad.
func put(place, kind, size, x, y, z, heading):
	if _classes.get(place, 0) != kind:
		if _shown.has(place):
			_shown[place].queue_free()
			_shown.erase(place)
		_classes[place] = kind
	if kind == 0:
		return
	var is_box = not has_node(CLASSES[kind])
	if not _shown.has(place):
		_shown[place] = get_node("box" if is_box else CLASSES[kind]).duplicate()
		_shown[place].visible = true
		add_child(_shown[place])
	# The middle of a box is half its height above the road.
	var node = _shown[place]
	node.transform.origin = DseFrame.position(x, y, z + 0.5 * size.y if is_box else z)
	node.rotation = DseFrame.rotation(heading)
	if is_box:
		node.scale = size
